# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread of a bake: messages in order, errors whole, and an end soon after it was asked for."""

import threading
import time

import numpy as np
import pytest
from radiosity_bake.core.errors import Cancelled, NoLightError
from radiosity_bake.core.progress import Progress
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators.job import BakeJob, Failed, Finished

EMPTY = Scene((), np.zeros(3))


def run(bake):
    job = BakeJob(bake, EMPTY, BakeSettings())
    job.start()
    return job


def test_progress_arrives_in_order_and_the_result_last():
    result = BakeResult((), {})

    def bake(scene, settings, progress):
        progress(Progress("First", 0.1))
        progress(Progress("Second", 0.9))
        return result

    job = run(bake)
    assert job.wait(5.0)
    messages = job.messages()
    assert [message.stage for message in messages[:-1]] == ["First", "Second"]
    assert isinstance(messages[-1], Finished) and messages[-1].result is result
    assert job.latest.stage == "Second"
    assert job.messages() == []


def test_the_bake_runs_outside_the_main_thread():
    seen = []

    def bake(scene, settings, progress):
        seen.append(threading.current_thread())

    assert run(bake).wait(5.0)
    assert seen[0] is not threading.main_thread()
    assert seen[0].daemon


@pytest.mark.parametrize("error", [NoLightError("dark"), ValueError("a bug"), MemoryError()])
def test_an_error_is_handed_over_with_its_traceback(error):
    def bake(scene, settings, progress):
        raise error

    job = run(bake)
    assert job.wait(5.0)
    (message,) = job.messages()
    assert isinstance(message, Failed)
    assert message.error is error
    assert message.error.__traceback__ is not None


def test_a_cancelled_bake_ends_at_its_next_message():
    def bake(scene, settings, progress):
        for step in range(10_000):
            progress(Progress("Form factors", step / 10_000))
            time.sleep(0.01)

    job = run(bake)
    while not job.messages():
        time.sleep(0.001)
    began = time.monotonic()
    job.cancel()
    assert job.wait(0.5)
    assert time.monotonic() - began < 0.5
    assert isinstance(job.messages()[-1].error, Cancelled)
