# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files are written whole or not at all."""

import os
import sys
from pathlib import Path

import pytest
from radiosity_bake.operators.files import FileError, check_writable, replaced


def names(folder):
    return [path.name for path in folder.iterdir()]


def test_a_file_takes_its_name_when_it_is_complete(tmp_path):
    path = tmp_path / "room.json"
    path.write_text("old")
    with replaced(path) as temporary:
        temporary.write_text("new")
        assert temporary.parent == tmp_path
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert names(tmp_path) == ["room.json"]


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "room.json"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replaced(path) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert names(tmp_path) == ["room.json"]


def test_a_full_disk_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match="could not be written: No space left"), replaced(tmp_path / "room.json"):
        raise OSError(28, "No space left on device")


def test_checking_leaves_no_trace(tmp_path):
    check_writable(tmp_path / "room.json", "The report")
    assert names(tmp_path) == []


@pytest.mark.parametrize("ending", [".json", ".blend", ".o" + 200 * "n"])
def test_a_name_may_be_as_long_as_names_can_be(tmp_path, ending):
    path = tmp_path / ("n" * (255 - len(ending)) + ending)
    check_writable(path, "The output")
    with replaced(path) as temporary:
        temporary.write_text("new")
    assert names(tmp_path) == [path.name]


def test_a_longer_name_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match=r"The output .* cannot be written \(File name too long\)"):
        check_writable(tmp_path / ("n" * 300 + ".blend"), "The output")
    assert names(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="elsewhere paths of that length need a special form")
def test_a_path_that_blender_would_cut_off_is_a_sentence(tmp_path):
    folder = tmp_path.joinpath(*["d" * 200] * 5)
    folder.mkdir(parents=True)
    check_writable(folder / "report.json", "The report")
    with pytest.raises(FileError, match="has a longer path than Blender can save to"):
        check_writable(folder / "room.blend", "The output")


def test_a_missing_folder_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match="there is no folder"):
        check_writable(tmp_path / "missing" / "room.json", "The report")


def test_a_folder_in_place_of_a_file_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match="is a folder"):
        check_writable(tmp_path, "The report")


@pytest.mark.skipif(os.name != "posix", reason="elsewhere the marks of a folder tell nothing")
def test_a_folder_that_nobody_may_write_to_is_a_sentence_for_root_too(tmp_path):
    folder = tmp_path / "kept"
    folder.mkdir(mode=0o555)
    with pytest.raises(FileError, match=r"cannot be written to \(it is read-only\)"):
        check_writable(folder / "room.blend", "The output")
    assert list(folder.iterdir()) == []


def test_a_read_only_file_is_a_sentence(tmp_path):
    path = tmp_path / "room.json"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(FileError, match="is read-only"):
        check_writable(path, "The report")


@pytest.mark.skipif(sys.platform != "linux", reason="needs a folder that nobody may write to")
def test_a_folder_that_cannot_be_written_to_is_a_sentence(monkeypatch):
    # As a mount that is read-only: its folders are marked as any other.
    monkeypatch.setattr("radiosity_bake.operators.files._ANYONE_WRITES", 0o777)
    with pytest.raises(FileError, match=r"cannot be written to \(No such"):
        check_writable(Path("/proc/room.json"), "The report")
