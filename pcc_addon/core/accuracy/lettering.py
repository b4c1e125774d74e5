"""A few letters and signs, five pixels wide and seven high, to write scales into pictures."""

from __future__ import annotations

import numpy as np

_ROWS = """
0 .###. #...# #..## #.#.# ##..# #...# .###.
1 ..#.. .##.. ..#.. ..#.. ..#.. ..#.. .###.
2 .###. #...# ....# ..##. .#... #.... #####
3 .###. #...# ....# ..##. ....# #...# .###.
4 ...#. ..##. .#.#. #..#. ##### ...#. ...#.
5 ##### #.... ####. ....# ....# #...# .###.
6 ..##. .#... #.... ####. #...# #...# .###.
7 ##### ....# ...#. ..#.. ..#.. .#... .#...
8 .###. #...# #...# .###. #...# #...# .###.
9 .###. #...# #...# .#### ....# ...#. .##..
+ ..... ..#.. ..#.. ##### ..#.. ..#.. .....
- ..... ..... ..... ##### ..... ..... .....
. ..... ..... ..... ..... ..... .##.. .##..
, ..... ..... ..... ..... .##.. ..#.. .#...
% ##..# ##..# ...#. ..#.. .#... #..## #..##
X #...# #...# .#.#. ..#.. .#.#. #...# #...#
Y #...# #...# .#.#. ..#.. ..#.. ..#.. ..#..
Z ##### ....# ...#. ..#.. .#... #.... #####
a ..... ..... .###. ....# .#### #...# .####
b #.... #.... ####. #...# #...# #...# ####.
c ..... ..... .#### #.... #.... #.... .####
d ....# ....# .#### #...# #...# #...# .####
e ..... ..... .###. #...# ##### #.... .###.
f ..##. .#... ####. .#... .#... .#... .#...
g ..... .#### #...# #...# .#### ....# .###.
h #.... #.... ####. #...# #...# #...# #...#
i ..#.. ..... .##.. ..#.. ..#.. ..#.. .###.
j ...#. ..... ..##. ...#. ...#. #..#. .##..
k #.... #.... #..#. #.#.. ##... #.#.. #..#.
l .##.. ..#.. ..#.. ..#.. ..#.. ..#.. .###.
m ..... ..... ##.#. #.#.# #.#.# #.#.# #.#.#
n ..... ..... ####. #...# #...# #...# #...#
o ..... ..... .###. #...# #...# #...# .###.
p ..... ..... ####. #...# ####. #.... #....
q ..... ..... .#### #...# .#### ....# ....#
r ..... ..... #.##. ##... #.... #.... #....
s ..... ..... .#### #.... .###. ....# ####.
t .#... .#... ####. .#... .#... .#... ..##.
u ..... ..... #...# #...# #...# #...# .####
v ..... ..... #...# #...# #...# .#.#. ..#..
w ..... ..... #.#.# #.#.# #.#.# #.#.# .#.#.
x ..... ..... #...# .#.#. ..#.. .#.#. #...#
y ..... ..... #...# #...# .#### ....# .###.
z ..... ..... ##### ...#. ..#.. .#... #####
"""
_GLYPHS = {
    line[0]: np.array([[pixel == "#" for pixel in row] for row in line.split()[1:]])
    for line in _ROWS.strip().splitlines()
} | {" ": np.zeros((7, 5), bool)}
HEIGHT, _ADVANCE = 7, 6  # pixels, at a scale of 1


def written(text: str, scale: int = 1) -> np.ndarray:
    """(7·scale, w) bool: a text, its pixels `scale` wide.

    Raises:
        KeyError: a letter that is not there.
    """
    mask = np.zeros((HEIGHT, _ADVANCE * len(text)), bool)
    for k, letter in enumerate(text):
        mask[:, _ADVANCE * k : _ADVANCE * k + 5] = _GLYPHS[letter]
    return mask[:, : max(_ADVANCE * len(text) - 1, 0)].repeat(scale, 0).repeat(scale, 1)


def write(
    picture: np.ndarray, text: str, row: int, column: int, colour: tuple[int, int, int], *, scale: int = 1
) -> None:
    """Write into a picture (h, w, 3) uint8, row 0 at the top; what does not fit is cut off.

    Args:
        row, column: of the upper left pixel, not below 0.
    """
    mask = written(text, scale)
    place = picture[row : row + mask.shape[0], column : column + mask.shape[1]]
    place[mask[: place.shape[0], : place.shape[1]]] = colour
