"""`deltamesh bench`: one's own meshes measured, saved and checked."""

from __future__ import annotations

import csv
import importlib.util
import io
import json
from dataclasses import fields

import click
import pytest
from commandline import cli

from deltamesh._options import ATTRIBUTE_BOUNDS, SEQUENCE_OPTIONS, Options
from deltamesh_cli.bench_options import labels_of
from deltamesh_cli.commands.bench import command
from deltamesh_cli.commands.encode import command as encode

FAST = "--method cartesian --bits 6,8"


def saved(path="rates.csv"):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def plant(column, factor, path="rates.csv"):
    """Make what was saved smaller by a factor, as if the first row had grown since."""
    rows = saved(path)
    rows[0][column] = f"{float(rows[0][column]) / factor:.6g}"
    if column == "bytes":
        rows[0][column] = str(round(float(rows[0][column])))
    with open(path, "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def test_a_table_of_every_method_with_every_rate(folder, capsys):
    assert cli("bench torus.ply --method cartesian,highpass --bits 6 -b 8") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "torus.ply: 2592 vertices, 5184 faces"
    assert [line.split()[:2] for line in lines[2:6]] == [
        [method, f"bits={bits}"] for method in ("cartesian", "highpass") for bits in (6, 8)
    ]
    assert cli("encode torus.ply x.dmesh --method highpass -b 8 --json") == 0
    encoded = json.loads(capsys.readouterr().out)
    (comments,) = [s["bytes"] for s in encoded["sections"] if s["id"] == "PART"]
    # What a file has beside the mesh: the source format, and what the source says of itself.
    assert int(lines[5].split()[2]) == encoded["bytes"] - len("ply") - comments
    assert sorted(path.name for path in folder.iterdir()) == ["torus.dmesh", "torus.ply", "x.dmesh"]


def test_every_number_and_choice_of_anchors_with_every_rate(folder, capsys):
    options = "--bits 0,6 --anchors 5,0.01 --anchor-method farthest,greedy --method highpass"
    assert cli(f"bench torus.ply {options}") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:4] for line in lines[2:10]] == [
        ["highpass", f"bits={bits}", f"anchors={anchors}", f"anchor_method={choice}"]
        for anchors in ("5", "0.01")
        for choice in ("farthest", "greedy")
        for bits in (0, 6)
    ]
    assert cli("bench torus.ply --method highpass,cartesian --anchors 5,9 -b 6") == 0
    codecs = [line.split("  ")[1] for line in capsys.readouterr().out.splitlines()[2:-1]]
    # The Cartesian method has no anchors.
    assert codecs == [
        *(f"highpass bits=6 anchors={anchors}" for anchors in (5, 9)),
        "cartesian bits=6",
    ]


def test_labels_are_all_methods_with_all_rates():
    given = {"method": (["refined", "highpass"],), "bits": ([5], [6]), "anchors": ()}
    labels = [f"{method} bits={bits}" for method in ("refined", "highpass") for bits in (5, 6)]
    assert labels_of(given) == labels
    assert labels_of({"method": (), "quality": ([3],)}) == ["auto quality=3"]
    with pytest.raises(click.UsageError, match="bits"):
        labels_of({"method": (["lossless"],), "bits": ([5],)})


def test_every_option_of_encoding_is_an_option_here():
    names = {one.name for one in command.params}
    # Meshes are measured without attributes, and each for itself.
    ours = {field.name for field in fields(Options)}
    ours -= {*ATTRIBUTE_BOUNDS, *SEQUENCE_OPTIONS, "importance"}
    assert names >= ours - {"source_format"}
    assert names >= {one.name for one in encode.params} & ours
    assert not names & {*ATTRIBUTE_BOUNDS, "importance"}


def test_reruns_pass_and_growth_of_one_percent_is_found(folder, capsys):
    assert cli(f"bench . {FAST} --save rates.csv") == 0
    assert [row["codec"] for row in saved()] == ["cartesian bits=6", "cartesian bits=8"]
    capsys.readouterr()
    assert cli("bench . --check rates.csv") == 0
    assert capsys.readouterr().out.endswith("2 rows match rates.csv\n")
    before = (folder / "rates.csv").read_bytes()

    plant("bytes", 1.01)
    assert cli("bench . --check rates.csv --tolerance 0.5%") == 4
    told = capsys.readouterr().err
    assert told.startswith("deltamesh: differences from rates.csv:\n")
    last = told.splitlines()[-1].split()
    assert last[:4] == ["torus.ply", "cartesian", "bits=6", "bytes"]
    assert last[-1] == "grew"
    assert float(last[-3]) == pytest.approx(1, abs=0.1)
    assert cli("bench . --check rates.csv --tolerance 0.02 -q") == 0

    (folder / "rates.csv").write_bytes(before)
    plant("normal_deg", 1.03)
    assert cli("bench . --check rates.csv") == 4
    assert "normal_deg" in capsys.readouterr().err
    assert cli("bench . --check rates.csv --error-tolerance 5%") == 0

    (folder / "rates.csv").write_bytes(before)
    plant("bytes", 0.9)
    assert cli("bench . --check rates.csv") == 0
    assert "shrank" in capsys.readouterr().err


def test_missing_and_new_rows_are_told(folder, capsys):
    (folder / "b.ply").write_bytes((folder / "torus.ply").read_bytes())
    assert cli(f"bench . {FAST} --save rates.csv -q") == 0
    (folder / "torus.ply").rename("c.ply")
    assert cli("bench . --check rates.csv --json") == 4
    output = capsys.readouterr()
    objects = [json.loads(line) for line in output.out.splitlines()]
    assert [one["mesh"] for one in objects if "bytes" in one] == ["b.ply"] * 2 + ["c.ply"] * 2
    told = [(one["mesh"], one["verdict"], one["worse"]) for one in objects if "check" in one]
    assert told == [("torus.ply", "gone", True)] * 2 + [("c.ply", "new", False)] * 2
    assert "gone" in output.err
    # Only files given: what became of the others is no question.
    assert cli("bench b.ply --check rates.csv -q") == 0
    # Other options are other rows.
    assert cli("bench b.ply --check rates.csv -q --method cartesian --bits 7") == 4


def test_what_cannot_be_measured_is_reported_and_the_rest_goes_on(folder, capsys):
    (folder / "a.ply").write_text("nothing of the kind")
    (folder / "huge.obj").write_text("v 0 0 0\nv 0 0 1e200\nv 1 0 0\nf 1 2 3\n")
    line = "bench a.ply nowhere.ply huge.obj torus.ply --method cartesian --save rates.csv"
    assert cli(f"{line} --json") == 1
    output = capsys.readouterr()
    objects = [json.loads(line) for line in output.out.splitlines()]
    assert [one.get("file") for one in objects] == ["a.ply", "nowhere.ply", "huge.obj", None]
    assert "huge.obj: cannot read: vertex 1 is beyond" in output.err
    assert [row["mesh"] for row in saved()] == ["torus.ply"]
    assert cli("bench torus.ply --max-error 1e-300,1 --method cartesian") == 4
    assert "cannot measure cartesian max_error=1e-300: " in capsys.readouterr().err


def test_csv_is_the_table_that_is_saved_and_times(folder, capsys):
    assert cli(f"bench torus.ply {FAST} --csv --save rates.csv") == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert float(rows[0].pop("encode_seconds")) > 0 < float(rows[0].pop("decode_seconds"))
    assert rows[0] == saved()[0]
    assert cli("bench torus.ply --csv --json") == 2


def test_files_are_named_by_their_place_in_a_folder(folder, capsys):
    data = (folder / "torus.ply").read_bytes()
    for name in ("set/a.ply", "set/deep/b.PLY", "other/a.ply"):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    (folder / "set" / "notes.txt").write_text("not a mesh")

    def names(line):
        assert cli(f"bench {line} --method cartesian --bits 4 --json") == 0
        return [json.loads(one)["mesh"] for one in capsys.readouterr().out.splitlines()]

    assert names("set") == ["a.ply"]
    assert names("set -r torus.ply") == ["a.ply", "deep/b.PLY", "torus.ply"]
    assert names("set other") == ["set/a.ply", "other/a.ply"]
    assert names("set set/a.ply") == ["a.ply"]
    (folder / "empty").mkdir()
    assert cli("bench empty") == 1
    assert "there is no mesh file in this folder" in capsys.readouterr().err


def test_a_saved_file_stays_unless_forced(folder, capsys):
    (folder / "rates.csv").write_text("mine")
    assert cli(f"bench torus.ply {FAST} --save rates.csv") == 1
    assert "exists already" in capsys.readouterr().err
    assert (folder / "rates.csv").read_text() == "mine"
    assert cli("bench torus.ply --check rates.csv") == 1
    assert "no table of rates" in capsys.readouterr().err
    assert cli("bench torus.ply --check nowhere.csv") == 1
    assert cli(f"bench torus.ply {FAST} --save rates.csv -f -q") == 0
    assert len(saved()) == 2


def test_isolated_vertices_stay_unless_dropped(folder, capsys):
    text = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (folder / "a.obj").write_text(text)

    def vertices(*options):
        assert cli("bench a.obj --method cartesian --json", *options) == 0
        return json.loads(capsys.readouterr().out.splitlines()[0])["vertices"]

    assert vertices() == 4
    assert vertices("--drop-isolated") == 3


@pytest.mark.parametrize(
    "options",
    [
        "--bits x",
        "--bits 6,",
        "--bits 99",
        "--method jpeg",
        "--coarse 4 --method highpass",
        "--peers jpeg",
        "--peer-bits 40",
        "--tolerance big",
        "--tolerance -1%",
    ],
)
def test_usage_errors(folder, options):
    assert cli(f"bench torus.ply {options}") == 2


def test_peers_are_measured_beside(folder, capsys):
    for package in ("DracoPy", "meshopt"):
        pytest.importorskip(package)
    assert cli(f"bench torus.ply {FAST} --peers draco,meshopt,zstd --peer-bits 8 --csv") == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    sizes = {row["codec"]: int(row["bytes"]) for row in rows}
    errors = {row["codec"]: row["rms"] for row in rows}
    assert list(sizes)[2:] == ["draco bits=8", "meshopt bits=8", "zstd"]
    assert sizes["cartesian bits=8"] < 1.03 * sizes["draco bits=8"] < sizes["meshopt bits=8"]
    assert sizes["meshopt bits=8"] < sizes["zstd"]
    assert errors["cartesian bits=8"] == errors["draco bits=8"] == errors["meshopt bits=8"]


def test_a_check_of_rows_of_peers_needs_no_options(folder):
    (folder / "a.obj").write_text("v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert cli("bench a.obj --method cartesian --peers zstd --save rates.csv -q") == 0
    assert [row["vertices"] for row in saved()] == ["3", "3"]
    assert cli("bench a.obj --check rates.csv") == 0


def test_missing_peers_are_skipped_and_named(folder, capsys, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert cli(f"bench torus.ply {FAST} --peers draco,meshopt --peer-bits 8") == 0
    output = capsys.readouterr()
    assert "skipped: draco bits=8: not installed: DracoPy (pip install" in output.err
    assert "draco" not in output.out
    (folder / "rates.csv").write_text(
        "mesh,codec,vertices,faces,bytes,bpv,rms,max,hausdorff,visual,normal_deg,dihedral_deg,sections\n"
        "torus.ply,meshopt bits=8,2592,5184,40128,123.9,0,0,0,0,0,0,\n"
    )
    assert cli("bench torus.ply --check rates.csv") == 4
    output = capsys.readouterr()
    assert "skipped: meshopt bits=8" in output.err
    assert "gone" in output.err
