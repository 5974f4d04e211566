import pytest
from file_cases import check_refused
from uncertain_graphs import WORKED, graph_of

from waybound.instances.errors import InputError, UsageError
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance

TEXT = "# name: lanes\n# start: s\n# goal: g\nfrom,to,mean,variance\ns,m,1,0.5\nm,g,2,0\n"


def read(tmp_path, text):
    path = tmp_path / "edges.csv"
    path.write_text(text)
    return read_instance(path)


def test_a_list_is_read_and_written(tmp_path):
    g = read(tmp_path, TEXT)
    assert (g.name, g.format, g.vertex_names, g.mean.tolist()) == ("lanes", "uncertain-edges", ("s", "m", "g"), [1.0, 2.0])
    write_instance(g, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == TEXT


def test_undirected_edges_stay_so(tmp_path):
    text = "# name: lanes\n# start: s\n# goal: g\n# undirected: true\nfrom,to,mean,variance,least\ns,m,1,0.5,0.25\nm,g,2,0,2\n"
    g = read(tmp_path, text)
    assert g.num_edges == 4
    write_instance(g, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == text


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# start: s\n", "", "setting start is missing"),
        ("# goal: g", "# goal: z", "the goal 'z' is no vertex of any edge"),
        ("0.5", "-0.5", "edges.csv:5: variance is negative; expected 0 or more; found -0.5"),
        ("m,1", "s,1", "edges.csv:5: an edge leads from a vertex to itself; found 's'"),
        ("m,g,2,0", "s,m,2,0", "edges.csv:6: the edge stands twice, first in line 5"),
        ("2,0", "two,0", "edges.csv:6: mean must be a finite number"),
        ("m,g", ",g", "edges.csv:6: from must name a vertex"),
        ("m,g,2,0", "g,m,2,0", "no path leads from s to g"),
        ("# goal: g", "# goal: g\n# undirected: perhaps", "edges.csv:4: undirected must be true or false; found 'perhaps'"),
    ],
)
def test_lists_that_break_a_rule_are_refused_with_their_line(tmp_path, old, new, message):
    check_refused(InputError, message, read, tmp_path, TEXT.replace(old, new))


def test_in_an_undirected_list_the_way_back_is_the_same_edge(tmp_path):
    with pytest.raises(InputError, match="stands twice, first in line 6"):
        read(tmp_path, TEXT.replace("# goal: g\n", "# goal: g\n# undirected: true\n").replace("m,g,2,0", "m,s,2,0"))


def test_what_has_no_place_in_a_list_is_not_written(tmp_path):
    check_refused(UsageError, "no place for positions; use json", write_instance, generate("prm-graph", 1, vertices=9), tmp_path / "g.csv")
    odd = graph_of([*WORKED, ("C", "B", 40, 2)], variable=[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 4])
    check_refused(UsageError, "no place for costs that edges share; use json", write_instance, odd, tmp_path / "g.csv")
    write_instance(graph_of(WORKED), tmp_path / "g.csv")
    assert read_instance(tmp_path / "g.csv").num_edges == 10
