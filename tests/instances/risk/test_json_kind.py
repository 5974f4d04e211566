import json

import numpy as np
import pytest
from uncertain_graphs import WORKED, graph_of

from waybound.instances.errors import InputError
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance


@pytest.mark.parametrize("directed", [True, False])
def test_what_is_written_is_read_to_the_bit(tmp_path, directed):
    g = generate("prm-graph", 3, vertices=12, directed=directed)
    write_instance(g, tmp_path / "g.json")
    again = read_instance(tmp_path / "g.json")
    assert again.digest() == g.digest()
    for key in ("positions", "least", "variables"):
        assert np.array_equal(getattr(again, key), getattr(g, key))
    write_instance(again, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text() == (tmp_path / "g.json").read_text()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["edges"].update(variance=[-1.0] * 10), "the variance of edge S -> A must be from 0"),
        (lambda d: d["edges"].update(mean=[1.0]), "edges.mean has a wrong length; expected 10; found 1"),
        (lambda d: d.update(goal=99), "the goal must be a vertex; expected 0 to 6"),
        (lambda d: d.update(problem="tsp"), "problem is none of graphs with uncertain costs"),
        (lambda d: d["vertices"].update(x=[0.0] * 7), "vertices has x alone"),
        (lambda d: d["vertices"].update(count=6, name=d["vertices"]["name"][:6]), "does not exist"),
        (lambda d: d["edges"].update(colour=[]), "edges has an unknown key 'colour'"),
        (lambda d: d.update(start=2), "start and goal are the same"),
        (lambda d: d.update(start=2, goal=0), "no path leads from G to S"),
    ],
)
def test_documents_that_break_a_rule_are_refused(tmp_path, change, message):
    write_instance(graph_of(WORKED), tmp_path / "g.json")
    data = json.loads((tmp_path / "g.json").read_text())
    change(data)
    (tmp_path / "g.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match=message):
        read_instance(tmp_path / "g.json")
