"""Which probes objects belong to, where several could have them."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.belonging import Belongings, are_apart, belongings, beside, layered
from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import Box, ProbeSpec

from .scenes import placement, spec


def owners(found: Belongings) -> set[str]:
    return set(found.owners.get("Wood", {}))


def test_nothing_belongs_to_nothing() -> None:
    assert belongings([], [placement("Table", "Wood")]) == Belongings()
    assert belongings([spec("Hall")], []) == Belongings()


def test_of_two_probes_an_object_belongs_to_the_one_that_has_more_of_it() -> None:
    """The boxes reach from −2 to 2 and from 2 to 6; the first has three quarters of the first object."""
    probes = [spec("Left"), spec("Right", 4.0)]
    found = belongings(probes, [placement("Mostly Left", "Wood", x=1.4, size=(1.0, 0.5, 0.5))])
    shares = {name: sum(objects.values()) for name, objects in found.owners["Wood"].items()}
    assert shares["Left"] > shares["Right"] > 0.0
    found = belongings(probes, [placement("Mostly Right", "Wood", x=2.6, size=(1.0, 0.5, 0.5))])
    shares = {name: sum(objects.values()) for name, objects in found.owners["Wood"].items()}
    assert shares["Right"] > shares["Left"] > 0.0


@pytest.mark.parametrize("turned", [False, True])
def test_of_two_probes_around_an_object_the_one_whose_middle_is_nearer_counts_for_more(turned: bool) -> None:
    probes = [spec("Small"), spec("Large", half=20.0)]
    found = belongings(probes[::-1] if turned else probes, [placement("Table", "Wood", x=0.2)])
    shares = {name: objects["Table"] for name, objects in found.owners["Wood"].items()}
    assert set(shares) == {"Small", "Large"}
    assert shares["Large"] > shares["Small"], "in half widths it is nearer to the middle of the large one"


def test_an_object_that_only_touches_the_influence_belongs_to_the_nearest() -> None:
    found = belongings([spec("Left"), spec("Right", 4.6)], [placement("Sill", "Wood", x=2.15, size=(0.05, 0.1, 0.1))])
    assert owners(found) == {"Left"}


@pytest.mark.parametrize(("aside", "expected"), [(0.0, {"Left", "Right"}), (2.4, {"Left"})])
def test_a_sliver_does_not_belong_to_the_neighbour(aside: float, expected: set[str]) -> None:
    """Of the 5 × 5 × 5 points of the object's bounds a face of 25 lies in the other room, or an edge of 5."""
    probes = [spec("Left", half=3.0), spec("Right", 5.0, padding=0.0)]
    table = placement("Table", "Wood", x=2.4, size=(0.7, 0.5, 0.5))
    moved = type(table)("Table", ("Wood",), table.corners + np.array([0.0, aside, 0.0]))
    assert owners(belongings(probes, [moved])) == expected


def test_a_probe_far_away_has_nothing() -> None:
    found = belongings([spec("Hall"), spec("Attic", 50.0)], [placement("Table", "Wood")])
    assert owners(found) == {"Hall"}
    far = belongings([spec("Hall")], [placement("Moon", "Wood", x=50.0)])
    assert far == Belongings(strays={"Wood": {"Moon": set()}})


@pytest.mark.parametrize(("gap", "reached"), [(0.2, True), (0.3, False)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_object_is_reached_as_far_as_the_influence_fades(gap: float, side: float, reached: bool) -> None:
    """The influence ends 0.01 + 0.25 m beyond the box."""
    found = belongings([spec("Hall")], [placement("Step", "Wood", x=side * (2.0 + gap + 0.5))])
    assert owners(found) == ({"Hall"} if reached else set())


def test_what_reaches_beyond_the_box_leaves_and_what_reaches_its_walls_touches() -> None:
    hall = [spec("Hall")]
    for size, leaves, touches in ((0.5, False, False), (2.0, False, True), (2.005, False, True), (2.1, True, True)):
        found = belongings(hall, [placement("Thing", "Wood", "Iron", size=(size, 0.5, 0.5))])
        assert found.leaving == ({"Hall": {"Wood", "Iron"}} if leaves else {}), size
        assert found.touching == ({"Hall": {"Wood", "Iron"}} if touches else {}), size


def test_an_object_that_is_not_to_show_a_probe_does_not_leave_its_box_and_may_leave_that_of_another() -> None:
    hall, large = spec("Hall", influence=Influence(excluded=frozenset({"Vase"}))), spec("Large", half=2.2)
    found = belongings([hall, large], [placement("Vase", "Wood", x=1.9)])
    assert found.leaving == found.touching == {"Large": {"Wood"}} and found.refusing == {"Hall": {"Vase"}}


def test_every_material_and_every_object_is_counted() -> None:
    placed = [placement("Table", "Wood", "Iron"), placement("Chair", "Wood", x=0.5), placement("Table", "Wood", x=-1.0)]
    found = belongings([spec("Hall")], placed)
    assert {name: set(of["Hall"]) for name, of in found.owners.items()} == {
        "Wood": {"Table", "Chair"},
        "Iron": {"Table"},
    }
    once = found.owners["Iron"]["Hall"]["Table"]
    assert once == pytest.approx(1.0, abs=2e-3), "an object wholly inside counts as one"
    assert found.owners["Wood"]["Hall"]["Table"] == pytest.approx(2.0 * once, abs=2e-3), "instances add up"


def test_a_turned_box_has_what_is_in_it_and_not_what_is_in_its_bounds() -> None:
    turn = np.eye(4)
    turn[:2, :2] = np.array([[1.0, -1.0], [1.0, 1.0]]) * 0.5**0.5
    diamond = ProbeSpec("Diamond", Box.from_matrix("Diamond", turn @ np.diag([2.0, 2.0, 2.0, 1.0])))
    corner = placement("In the corner", "Wood", size=(0.1, 0.1, 0.1))
    moved = type(corner)("In the corner", ("Wood",), corner.corners + np.array([2.3, 2.3, 0.0]))
    tip = type(corner)("In the tip", ("Iron",), corner.corners + np.array([2.5, 0.0, 0.0]))
    found = belongings([diamond], [moved, tip])
    assert set(found.owners) == {"Iron"}


@pytest.mark.parametrize("turned", [False, True])
def test_between_two_that_have_equally_little_the_name_decides(turned: bool) -> None:
    probes = [spec("A", -2.2), spec("B", 2.2)]
    found = belongings(probes[::-1] if turned else probes, [placement("Post", "Wood", size=(0.05, 0.05, 0.05))])
    assert owners(found) == {"A"}


def test_what_lies_in_the_padding_counts_as_inside() -> None:
    found = belongings([spec("Hall")], [placement("Poster", "Wood", x=2.005, size=(0.001, 0.5, 0.5))])
    assert found.owners["Wood"]["Hall"]["Poster"] == pytest.approx(1.0, abs=2e-3) and found.leaving == {}


def test_the_influence_of_a_small_box_fades_as_far_as_that_of_a_large_one() -> None:
    found = belongings([spec("Niche", half=0.25)], [placement("Step", "Wood", x=0.55, size=(0.1, 0.1, 0.1))])
    assert owners(found) == {"Niche"}


def test_a_share_counts_before_nearness() -> None:
    """A fifth lies in the small box and an edge in the large one, whose middle is nearer in half widths."""
    matrix = np.diag([20.0, 20.0, 20.0, 1.0])
    matrix[:2, 3] = 22.69, 20.49
    large = ProbeSpec("Large", Box.from_matrix("Large", matrix), padding=0.01)
    beam = placement("Beam", "Wood", x=1.8, size=(0.9, 0.5, 0.5))
    assert owners(belongings([large], [beam])) == {"Large"}
    assert owners(belongings([large, spec("Small", half=1.0)], [beam])) == {"Small"}


@pytest.mark.parametrize(
    ("x", "expected"),
    [(3.0, False), (3.9, False), (3.96, True), (4.0, True), (4.5, True), (20.0, True)],
)
def test_boxes_are_apart_from_where_they_have_less_than_the_handover_in_common(x: float, expected: bool) -> None:
    """A fifth of the falloff of 0.25 m."""
    assert are_apart(spec("A"), spec("B", x)) is are_apart(spec("B", x), spec("A")) is expected
    assert not are_apart(spec("A"), spec("B", x, animated=True)), "nobody knows where it goes"


def test_a_box_within_another_is_not_apart_and_influences_count() -> None:
    assert not are_apart(spec("Large", half=5.0), spec("Small", 1.0, half=0.5))
    assert are_apart(spec("A"), spec("B", 4.5))
    assert not are_apart(spec("A", influence=Influence(high=(1.0, 0.0, 0.0))), spec("B", 4.5))
    assert are_apart(spec("A", influence=Influence(high=(-1.0, 0.0, 0.0))), spec("B", 3.2))


def test_each_probe_keeps_out_of_those_before_it_that_are_apart() -> None:
    hall, niche, room = spec("Hall", half=5.0), spec("Niche", 1.0, half=0.5), spec("Room", 8.0)
    assert beside([hall, niche, room]) == ((), (), (0, 1)) and beside([room, hall, niche]) == ((), (0,), (0,))


def test_layers_go_by_priority_then_size_then_rank() -> None:
    specs = {"A": spec("A"), "B": spec("B"), "Large": spec("Large", half=9.0)}
    assert layered(["A", "B", "Large"], specs) == ["Large", "B", "A"]
    specs["Large"] = spec("Large", half=9.0, influence=Influence(priority=1))
    assert layered(["B", "Large", "A"], specs) == ["A", "B", "Large"]
    assert layered(["A", "B", "Large"], specs, {"A", "Large"}) == ["A", "B", "Large"], "priority comes first"
    assert layered(["A", "B"], specs, {"A"}) == ["A", "B"], "then whose pictures are its own"
