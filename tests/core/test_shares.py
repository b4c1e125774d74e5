"""Shares of a bake: everything is somebody's, nothing is two people's."""

from __future__ import annotations

import pytest

from pcc_addon.core.errors import PccError
from pcc_addon.core.shares import Share, dealt


@pytest.mark.parametrize("of", [1, 2, 3, 5, 7, 12, 30, 100])
@pytest.mark.parametrize("costs", [[1.0], [5.0, 1.0, 1.0, 1.0], [0.0, 0.0], [3.0] * 5])
def test_each_piece_is_in_one_share(costs: list[float], of: int) -> None:
    pieces = [6, 2, 1, 6, 6][: len(costs)]
    shares = [dealt(costs, pieces, Share(k + 1, of)) for k in range(of)]
    for index, count in enumerate(pieces):
        assert sorted(k for share in shares for k in share[index]) == list(range(count))


def test_probes_stay_whole_where_there_are_enough_and_shares_cost_alike() -> None:
    costs = [8.0, 4.0, 2.0, 1.0, 1.0]
    found = [dealt(costs, [6] * 5, Share(k + 1, 2)) for k in range(2)]
    assert all(len(part) in (0, 6) for share in found for part in share)
    assert [sum(c for c, part in zip(costs, share, strict=True) if part) for share in found] == [8.0, 8.0]
    assert all(any(share) for share in (dealt(costs, [6] * 5, Share(k + 1, 5)) for k in range(5)))


def test_faces_are_shared_where_probes_are_few() -> None:
    found = [dealt([1.0], [6], Share(k + 1, 3)) for k in range(3)]
    assert found == [[range(2)], [range(2, 4)], [range(4, 6)]]


@pytest.mark.parametrize("text", ["", "2", "0/3", "4/3", "1/0", "a/b", "-1/3", "1/2/3"])
def test_what_is_no_share_is_refused(text: str) -> None:
    with pytest.raises(PccError, match="as 2/8"):
        Share.parse(text)
