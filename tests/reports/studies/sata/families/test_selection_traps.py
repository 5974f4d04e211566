from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.families import selection_traps as traps


def cases(family):
    return [family.case(k, 1) for k in range(family.size)]


def test_copies_stand_side_by_side():
    one = traps.robots([[[2, 0], [0, 1]], [[2, 0]]], "one")
    three = traps.copies(one, 3)
    assert (three.graph.num_robots, three.graph.num_actions, three.graph.num_targets) == (6, 9, 6)
    assert optimum(three).value == 3 * optimum(one).value == 9.0


def test_density_alone_is_arbitrarily_bad():
    case = max(cases(traps.DENSITY_TRAPS), key=lambda case: case.solved().value)
    assert case.solved().value == 1e4
