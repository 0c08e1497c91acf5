# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run all checks and tests, one stage after the other, and count them together at the end.

    .venv/main/bin/python -m tools.run_tests             everything (`make test`)
    .venv/main/bin/python -m tools.run_tests core lint   only the stages whose names begin so

A stage that fails does not stop the next one. The exit code is 0 only if every stage ended well.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .environments import ROOT, Environment, present_environments
from .real_blender import RealBlender, RealBlenderError

RESULTS = ROOT / ".cache" / "test-results"
IN_CI = os.environ.get("CI") == "true"


@dataclass(frozen=True)
class Counts:
    """How many tests ended how."""

    passed: int = 0
    failed: int = 0
    skipped: int = 0

    def __add__(self, other: Counts) -> Counts:
        return Counts(self.passed + other.passed, self.failed + other.failed, self.skipped + other.skipped)


@dataclass(frozen=True)
class Stage:
    """One step of the run; `command` is made when its turn comes and may be None, for a step that is left out."""

    name: str
    command: Callable[[], list[str] | None]
    has_tests: bool = True

    @property
    def results(self) -> Path:
        return RESULTS / f"{self.name.replace(' ', '-')}.xml"


@dataclass(frozen=True)
class Outcome:
    stage: Stage
    state: str  # "passed", "FAILED" or "LEFT OUT"
    seconds: float
    counts: Counts


def tool(*arguments: str) -> Callable[[], list[str]]:
    """Run a Python module of the environment that this runs in."""
    return lambda: [sys.executable, "-m", *arguments]


def pytest_stage(name: str, environment: Environment, *arguments: str) -> Stage:
    """Run pytest in one environment, with its results in a file for the count at the end."""
    stage = Stage(name, lambda: None)
    command = [str(environment.python), "-m", "pytest", *arguments, f"--junitxml={stage.results}"]
    return Stage(name, lambda: command)


def types_command(environment: Environment) -> Callable[[], list[str] | None]:
    """Check the types of `core`, against a numpy that has them."""

    def command() -> list[str] | None:
        if environment.python_version == "3.11":
            print("Types are checked with Python 3.13: the numpy of Blender 4.2 has only some.", flush=True)
            return None
        return [str(environment.python), "-m", "mypy", "core"]

    return command


def real_blender_command(stage_name: str) -> Callable[[], list[str] | None]:
    """Run tests/blender inside Debian's Blender, where that can be had."""

    def command() -> list[str] | None:
        try:
            RealBlender().prepare()
        except RealBlenderError as error:
            print(f"There is no real Blender to test in: {error}", flush=True)
            return None
        results = Stage(stage_name, lambda: None).results
        blender = str(ROOT / "tools/real_blender.py")
        return [sys.executable, "-m", "tools.test_blender", blender, f"--junitxml={results}"]

    return command


def all_stages() -> list[Stage]:
    """Return the stages in their order: cheap ones first."""
    environments = present_environments()
    newest = environments[-1]
    stages = [
        Stage("lint: ruff format", tool("ruff", "format", "--check", "."), has_tests=False),
        Stage("lint: ruff check", tool("ruff", "check", "."), has_tests=False),
        Stage("lint: mypy core", types_command(newest), has_tests=False),
    ]
    stages += [pytest_stage(f"core {each.name}", each, "tests/core") for each in environments]
    stages += [pytest_stage(f"blender {each.name}", each, "tests/blender") for each in environments]
    name = "blender in Debian's Blender"
    stages += [
        Stage("zip", tool("tools.build"), has_tests=False),
        Stage(name, real_blender_command(name)),
        pytest_stage("package", newest, "tests/package"),
        pytest_stage("window", newest, "tests/window"),
    ]
    return stages


def read_counts(path: Path) -> Counts:
    """Read pytest's own results file; of one that was not written to its end nothing counts."""
    try:
        suites = ElementTree.parse(path).getroot().iter("testsuite")
    except ElementTree.ParseError as error:
        print(f"{path} is not whole: {error}", flush=True)
        return Counts()
    total = Counts()
    for suite in suites:
        tests, failures, errors, skipped = (
            int(suite.get(key, "0")) for key in ("tests", "failures", "errors", "skipped")
        )
        failed = failures + errors
        total += Counts(max(tests - failed - skipped, 0), failed, skipped)
    return total


def run(stage: Stage) -> Outcome:
    """Run one stage and tell how it ended."""
    print(f"\n===== {stage.name} =====", flush=True)
    stage.results.unlink(missing_ok=True)
    started = time.monotonic()
    command = stage.command()
    if command is None:
        return Outcome(stage, "FAILED" if IN_CI else "LEFT OUT", time.monotonic() - started, Counts())
    code = subprocess.run(command, cwd=ROOT, check=False).returncode
    counts = read_counts(stage.results) if stage.has_tests and stage.results.exists() else Counts()
    good = code == 0 and (counts.passed > 0 or not stage.has_tests)
    return Outcome(stage, "passed" if good else "FAILED", time.monotonic() - started, counts)


def report(outcomes: Sequence[Outcome]) -> int:
    """Print one line a stage and the sum, and return the exit code."""
    print("\n===== all stages =====")
    for each in outcomes:
        counts = f"{each.counts.passed} passed, {each.counts.failed} failed" if each.stage.has_tests else ""
        skipped = f", {each.counts.skipped} SKIPPED" if each.counts.skipped else ""
        print(f"{each.state:8}  {each.seconds:6.1f} s  {each.stage.name:30} {counts}{skipped}")
    total = sum((each.counts for each in outcomes), Counts())
    bad = [each for each in outcomes if each.state == "FAILED"]
    left_out = [each.stage.name for each in outcomes if each.state == "LEFT OUT"]
    if left_out:
        print(f"!!! LEFT OUT, and so untested here: {', '.join(left_out)}; the reason stands above")
    if bad:
        print(f"!!! FAILED: {', '.join(each.stage.name for each in bad)}")
    print(f"tests: {total.passed} passed, {total.failed} failed, {total.skipped} skipped", flush=True)
    return 1 if bad else 0


def main(arguments: Sequence[str]) -> int:
    stages = [stage for stage in all_stages() if not arguments or stage.name.startswith(tuple(arguments))]
    if not stages:
        print(f"no stage begins with {' or '.join(arguments)}", file=sys.stderr)
        return 2
    RESULTS.mkdir(parents=True, exist_ok=True)
    return report([run(stage) for stage in stages])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
