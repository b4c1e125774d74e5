"""Keys of pictures, and the ladder of levels."""

from __future__ import annotations

import pytest

from pcc_addon.core.pictures import LADDER, PictureKey, PictureKind


def test_the_ladder_is_what_files_were_baked_with() -> None:
    """Its steps were chosen by measurement (docs/ladder.md); another ladder makes every bake stale."""
    assert LADDER == (0.0, 0.05, 0.1, 0.16, 0.23, 0.32, 0.44, 0.6)


def test_a_key_and_its_text_are_inverses() -> None:
    key = PictureKey(PictureKind.RADIANCE, 12)
    assert key.text == "radiance-12" and PictureKey.parse(key.text) == key


def test_a_picture_of_a_sequence_is_told_by_its_number() -> None:
    key = PictureKey(PictureKind.RADIANCE, 2, 17)
    assert key.text == "radiance-2@17" and PictureKey.parse(key.text) == key
    assert key.family == PictureKey(PictureKind.RADIANCE, 2).family == "radiance-2"
    assert PictureKey.parse("radiance-2@0") != PictureKey.parse("radiance-2")


@pytest.mark.parametrize(
    "text",
    [
        "radiance-2@",
        "radiance-2@x",
        "radiance-2@-1",
        "radiance-2@1@2",
        "",
        "radiance",
        "radiance-",
        "radiance-x",
        "heat-1",
        "-1",
        "1",
    ],
)
def test_another_text_is_no_key(text: str) -> None:
    with pytest.raises(ValueError):
        PictureKey.parse(text)


def test_keys_sort_by_level() -> None:
    keys = [PictureKey(PictureKind.RADIANCE, k) for k in (10, 2, 0)]
    assert [key.level for key in sorted(keys)] == [0, 2, 10]
