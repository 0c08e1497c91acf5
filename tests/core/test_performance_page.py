# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's arithmetic and its page: time at equal error, and a text for whatever numbers there are."""

from __future__ import annotations

import json

import pytest

from bench.convergence import cost_at, improving
from bench.page import page
from bench.page.profile import MUCH, REASONS
from bench.profile import RAY_LIBRARY
from bench.publish import DOCS, brought_up_to_date
from bench.results import collect


def test_only_settings_that_no_cheaper_one_beats_count():
    assert improving([(4.0, 0.02), (1.0, 0.05), (2.0, 0.06), (8.0, 0.02)]) == [(1.0, 0.05), (4.0, 0.02)]


def test_time_at_equal_error_lies_on_the_line_between_two_settings():
    # Error as one over the square root of time: 1% lies where time is four times that of 2%.
    found = cost_at([(1.0, 0.04), (16.0, 0.01)], 0.02)
    assert found.kind == "between"
    assert found.cost == pytest.approx(4.0)


def test_beyond_the_best_setting_the_error_falls_as_one_over_the_square_root():
    found = cost_at([(1.0, 0.04), (16.0, 0.02)], 0.01)
    assert found.kind == "beyond"
    assert found.cost == pytest.approx(64.0)


def test_an_error_above_that_of_the_cheapest_setting_costs_at_most_that():
    assert cost_at([(3.0, 0.04), (16.0, 0.02)], 0.1) == cost_at([(3.0, 0.04)], 0.04)
    assert cost_at([(3.0, 0.04)], 0.1).kind == "below"
    assert cost_at([], 0.1) is None


def entry(method: str, setting: str, seconds: float, rms: float, points: int = 1000, run: str = "2026-01-01") -> dict:
    """Return a measurement as the benchmark writes it."""
    stages = {"form_factors": 0.6 * seconds, "gathering": 0.4 * seconds, "total": seconds}
    return {
        "method": method,
        "setting": setting,
        "seconds": seconds,
        "processor_seconds": 2.0 * seconds,
        "others": 0.0,
        "points": points,
        "patches": points,
        "rays": 64 * points,
        "run": run,
        "accuracy": {"rms": rms, "lit_rms": rms, "bias": -rms / 10, "p95": 2 * rms},
        "report": {
            "estimated_error": 2 * rms,
            "seconds_in_ray_library": seconds,
            "seconds": stages,
            "warnings": [],
        },
    }


def measured(folder, *results: dict) -> dict:
    """Return the document of one scene that was measured."""
    versions = {"python": "3.13", "numpy": "2"}
    scene = {
        "machine": {"processor": "A processor", "cores": 2, "system": "Linux", "versions": versions},
        "scene": "cornell_box",
        "run": "2026-01-01",
        "triangles": 38,
        "probes": 4000,
        "reference_samples": 16384,
        "reference_noise": 0.004,
        "results": list(results),
    }
    (folder / "bench").mkdir(exist_ok=True)
    (folder / "bench" / "cornell_box.json").write_text(json.dumps(scene))
    return collect(folder)


def test_a_page_without_measurements_says_so(tmp_path):
    assert "Nothing has been measured" in page(collect(tmp_path))


def test_the_page_states_how_many_times_faster_and_whether_that_is_the_goal(tmp_path):
    peer = [
        entry("Mitsuba 3 at the probes", "64 samples", 10.0, 0.02),
        entry("Mitsuba 3 at the probes", "16", 2.5, 0.04),
    ]
    text = page(measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.02), *peer))
    # At 2% Mitsuba takes 10 s, ours 1 s: 10 times, where 20 are wanted on this scene.
    assert "| Cornell box, GOOD | 2.00% | 1.00 | 10 (10) of 20 |" in text
    assert (
        "| 20 times faster than Mitsuba 3 at the probes on the Cornell box, at the error of GOOD | 10 (Cornell box)"
        in text
    )
    text = page(measured(tmp_path, entry("Radiosity Bake", "GOOD", 0.25, 0.02), *peer))
    assert "| Cornell box, GOOD | 2.00% | 0.25 | 40 (40) |" in text


def test_a_goal_is_judged_by_the_clock_that_favours_us_less(tmp_path):
    peer = entry("Mitsuba 3 at the probes", "64 samples", 30.0, 0.02)
    by_processor = measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.02), {**peer, "processor_seconds": 20.0})
    text = page(by_processor)
    # 30 times by wall clock, 20 s over 2 s by processor time; 20 are wanted on this scene.
    assert "| Cornell box, GOOD | 2.00% | 1.00 | ≤ 30 (10) of 20 |" in text
    assert "on the Cornell box, at the error of GOOD | 10 (Cornell box) | **no** |" in text
    by_wall = measured(tmp_path, entry("Radiosity Bake", "GOOD", 2.0, 0.02), {**peer, "processor_seconds": 200.0})
    assert "on the Cornell box, at the error of GOOD | 15 (Cornell box) | **no** |" in page(by_wall)


def test_the_page_says_when_the_machine_was_busy_and_when_peers_are_of_another_run(tmp_path):
    disturbed = {**entry("Radiosity Bake", "GOOD", 1.0, 0.02), "others": 0.5}
    text = page(measured(tmp_path, disturbed, entry("Cycles bake to vertices", "16", 9.0, 0.1, run="2025-12-24")))
    assert "up to 50% of its processors" in text
    assert "other programs in another run (2025-12-24)" in text
    text = page(measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.02)))
    assert "busy" not in text.partition("## Goals")[0]
    assert "all in one run" in text


def test_a_missed_goal_is_explained_with_what_was_measured(tmp_path):
    ours, peer = (
        entry("Radiosity Bake", "GOOD", 1.0, 0.02, points=8000),
        entry("Mitsuba 3 at the probes", "64", 10.0, 0.02),
    )
    text = " ".join(page(measured(tmp_path, ours, peer)).split())
    # 10 times faster with 8,000 vertices for its 4,000 points.
    assert "10 times faster, not 20. It computes the 4,000 points" in text
    assert "makes us 20 times faster for each point computed" in text
    fast = {**ours, "seconds": 0.1, "processor_seconds": 0.2}
    assert "It computes the 4,000 points" not in page(measured(tmp_path, fast, peer))


def scaled(patches: int, seconds: float) -> dict:
    """Return a bake as `bench.scaling` writes it."""
    counts = {"patches": patches, "vertices": patches // 2, "rays": 64 * patches, "warnings": []}
    return {**counts, "seconds": seconds, "processor_seconds": seconds, "others": 0.0, "peak_bytes": 3_900_000_000}


def test_the_page_tells_how_time_grows_and_what_a_million_triangles_take(tmp_path):
    document = measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.02))
    rows = [scaled(1000, 1.0), scaled(10_000, 5.0), scaled(100_000, 100.0)]
    dense = {"triangles": 1_001_000, "core": scaled(3000, 200.0), "operator": scaled(3000, 300.0)}
    told = {"run": "2026-01-01", "quality": "GOOD", "memory_limit": 4096, "patches": rows, "dense": dense}
    text = " ".join(page({**document, "scaling": told}).split())
    # A hundred times the patches take a hundred times as long, and in the last step ten times 20 times as long.
    assert "grows as patches to the power of 1.00 over the whole range, of 1.30 in the last step" in text
    assert "The statue made of 1,001,000 triangles" in text
    assert (
        "| time that grows no faster than patches | to the power of 1.00 (Corridor, to 100,000 of them) | yes |" in text
    )
    assert "| 1,001,000 triangles below 4 GB | 3.9 GB (Statue) | yes |" in text
    assert "| 1,001,000 triangles in at most 10 minutes | 5.0 minutes (Statue) | yes |" in text
    assert "| whole operator | 3,000 | 1,500 | 192,000 | 300 | 300 | 3.90 GB |" in text


def test_the_page_explains_what_takes_much_of_the_time(tmp_path):
    document = measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.02))
    row = {"scene": "cornell_box", "rays": 1_000_000, "processor_seconds": 1.0}
    told = {"run": "2026-01-01", "quality": "GOOD", "scenes": [{**row, "shares": {"direct": 0.6, "ray library": 0.4}}]}
    text = " ".join(page({**document, "profile": told}).split())
    assert "What takes more than 15% and is no ray: `direct`" in text
    # 40% of a second for a million rays, where half is wanted.
    assert "Cornell box 40%, 400 of 1,000 nanoseconds a ray" in text


def test_an_exact_bake_does_not_break_the_page(tmp_path):
    text = page(measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.0)))
    assert "0.00%" in text


def test_the_published_page_is_what_its_numbers_give():
    document = json.loads((DOCS / "performance.json").read_text(encoding="utf-8"))
    assert (DOCS / "performance.md").read_text(encoding="utf-8") == page(document)


def test_a_scene_measured_later_takes_the_place_of_the_published_one_and_no_other(tmp_path):
    published = {
        "scenes": [{"scene": "cornell_box", "run": "2"}, {"scene": "statue", "run": "2"}],
        "profile": {"run": "2"},
    }
    (tmp_path / "bench").mkdir()
    for name, run in (("cornell_box", "3"), ("statue", "1")):
        text = json.dumps({"scene": name, "run": run, "results": []})
        (tmp_path / "bench" / f"{name}.json").write_text(text, encoding="utf-8")
    (tmp_path / "profile.json").write_text(json.dumps({"run": "1"}), encoding="utf-8")
    together = brought_up_to_date(published, tmp_path)
    assert [(scene["scene"], scene["run"]) for scene in together["scenes"]] == [("cornell_box", "3"), ("statue", "2")]
    assert together["profile"] == {"run": "2"}


def test_a_method_whose_time_grows_faster_than_its_patches_misses_the_goal(tmp_path):
    def uniform(patches: int, seconds: float) -> dict:
        found = entry("Radiosity Bake, uniform", f"n = {1 / patches} m", seconds, 0.02)
        return {**found, "patches": patches, "processor_seconds": seconds}

    text = page(measured(tmp_path, uniform(1000, 1.0), uniform(10_000, 20.0)))
    assert "| time that grows no faster than patches | to the power of 1.30 (Cornell box, uniform) | **no** |" in text
    text = page(measured(tmp_path, uniform(1000, 1.0), uniform(10_000, 8.0)))
    assert "| time that grows no faster than patches | to the power of 0.90 (Cornell box, uniform) | yes |" in text


def test_the_published_page_explains_whatever_takes_much_of_the_time_and_is_no_ray():
    rows = json.loads((DOCS / "performance.json").read_text(encoding="utf-8"))["profile"]["scenes"]
    large = {module for row in rows for module, share in row["shares"].items() if share >= MUCH}
    assert large <= {RAY_LIBRARY, *REASONS}


def test_an_error_that_is_too_large_is_told_with_what_the_bake_warned_of(tmp_path):
    ours = entry("Radiosity Bake", "HIGH", 1.0, 0.02)
    warned = {**ours, "report": {**ours["report"], "warnings": ["The memory limit ended the search early"]}}
    text = " ".join(page(measured(tmp_path, warned)).split())
    assert 'it estimates 4.00%, and warns: "The memory limit ended the search early".' in text
    assert "and warns" not in page(measured(tmp_path, ours))


def test_the_finest_row_of_a_paper_scene_that_gains_too_little_is_explained(tmp_path):
    def half(seconds: float, fragments: int) -> dict:
        stages = {"gathering": 0.5 * seconds, "total": seconds}
        both = {"seconds": seconds, "processor_seconds": seconds, "rms": 0.01, "rays": 1000, "stages": stages}
        return {**both, "fragments": fragments, "vertices": 2 * fragments}

    row = {"scene": "paper_scene_1", "minimum_size": 0.1, "uniform": half(2.0, 900), "adaptive": half(1.0, 100)}
    table = {"rows": [row], "threshold": 0.02, "quality": "GOOD", "run": "2026-01-01"}
    document = measured(tmp_path, entry("Radiosity Bake", "GOOD", 1.0, 0.01))
    text = " ".join(page({**document, "paper_table": table}).split())
    assert "**The finest row of Paper scene 1.** It gains 50.0%, not 60%." in text
    assert "gathered at 200 vertices in place of 1,800, which takes 0.50 of 1.00 seconds" in text
    fast = {**row, "adaptive": half(0.5, 100)}
    assert "The finest row of" not in page({**document, "paper_table": {**table, "rows": [fast]}})
