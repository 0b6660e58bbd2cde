"""The blocks of docs/batch.md run, in their order, and do what is said of them."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

import children
import guides
import meshes
import pytest
from documents import script
from places import ROOT
from servers import served

from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import from_triangles

GUIDE = ROOT / "docs" / "batch.md"
MESHES = {"scans/a.ply": meshes.icosphere(2), "scans/sub/b.obj": meshes.torus(9, 7)}

pytestmark = pytest.mark.skipif(os.name != "posix", reason="blocks for a shell of POSIX")

# `deltamesh` of these sources, whatever is installed; a failure of any line is one of the block.


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    for name, mesh in MESHES.items():
        path = top / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(mesh_bytes(from_triangles(*mesh), path.suffix[1:]))
    return top


def run(folder: Path, name: str, **environment: str) -> str:
    """Run a block in a process group of its own, which does not outlive it; return what it said."""
    code = script(".ci/readme_block.py").block(name, GUIDE)
    is_python = f"<!-- run: {name} -->\n```python" in GUIDE.read_text(encoding="utf-8")
    path, log = folder / ("block.py" if is_python else "block.sh"), folder / "log"
    path.write_text(code if is_python else guides.PRELUDE + code)
    places = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    # To a file: what runs in the background would keep a pipe open.
    with (
        log.open("w") as stream,
        children.started(
            [sys.executable if is_python else "bash", path.name],
            cwd=folder,
            env={**os.environ, "PYTHON": sys.executable, "PATH": places, **environment},
            stdout=stream,
            stderr=stream,
        ) as child,
    ):
        code = child.process.wait()
    assert code == 0, log.read_text()
    return log.read_text()


def made(folder: Path, name: str) -> list[str]:
    """The files in a folder, by their names in it."""
    top = folder / name
    return sorted(str(path.relative_to(top)) for path in top.rglob("*") if path.is_file())


def done(folder: Path, name: str) -> int:
    lines = (folder / name).read_text().splitlines()
    return sum(json.loads(line)["status"] == "done" for line in lines)


PACKED = [f"{name}.dmesh" for name in MESHES]


def test_every_block_is_run_here() -> None:
    text = GUIDE.read_text(encoding="utf-8")
    blocks = re.findall(r"<!-- run: ([\w-]+) -->\n```", text)
    assert len(blocks) == text.count("```") / 2
    here = Path(__file__).read_text(encoding="utf-8")
    for block in blocks:
        assert f'run(folder, "{block}"' in here


def test_a_folder_and_back(folder: Path) -> None:
    assert "scans/a.ply -> packed/scans/a.ply.dmesh\n" in run(folder, "folder")
    assert made(folder, "packed") == PACKED
    run(folder, "back")
    assert made(folder, "meshes") == ["a.obj", "b.obj"]
    run(folder, "which")
    assert made(folder, "plys") == PACKED[:1]
    assert made(folder, "objs") == ["b.obj.dmesh"]


def test_cores_and_a_manifest(folder: Path) -> None:
    run(folder, "cores")
    assert made(folder, "fast") == ["a.ply.dmesh", "b.obj.dmesh"]
    assert "done before" in run(folder, "resume")
    assert done(folder, "run.jsonl") == 2
    assert [line.split()[0] for line in run(folder, "records").splitlines()] == list(MESHES)


@pytest.mark.slow
def test_clusters(folder: Path) -> None:
    pytest.importorskip("distributed")
    run(folder, "dask-local")
    run(folder, "dask")
    for name in ("dasked", "clustered"):
        assert made(folder, name) == ["a.ply.dmesh", "b.obj.dmesh"]
        assert done(folder, f"{name}.jsonl") == 2


@pytest.mark.slow
def test_files_at_urls(folder: Path) -> None:
    for package in ("distributed", "fsspec", "aiohttp"):
        pytest.importorskip(package)
    with served() as (url, files):
        files.update({f"in/{Path(name).name}": (folder / name).read_bytes() for name in MESHES})
        files["list.txt"] = "".join(f"{url}/{name}\n" for name in files).encode()
        assert "skipped" in run(folder, "remote", STORE=url)
        assert sorted(files)[-2:] == ["packed/a.ply.dmesh", "packed/b.obj.dmesh"]
    assert done(folder, "remote.jsonl") == 2


@pytest.mark.slow
def test_an_array(folder: Path) -> None:
    array = {"MIN": "0", "MAX": "1", "COUNT": "2", "STEP": "1"}
    for task in "01":
        variables = {f"SLURM_ARRAY_TASK_{name}": value for name, value in array.items()}
        run(folder, "slurm", SLURM_ARRAY_TASK_ID=task, SLURM_CPUS_PER_TASK="2", **variables)
        assert done(folder, f"share-{task}.jsonl") == 1
    assert made(folder, "shared") == PACKED


@pytest.mark.slow
def test_ci_and_python(folder: Path) -> None:
    run(folder, "ci")
    *each, last = (folder / "report.jsonl").read_text().splitlines()
    assert [json.loads(line)["source"] for line in each] == list(MESHES)
    assert json.loads(last)["summary"]["exit_code"] == 0
    assert run(folder, "python").startswith("scans/a.ply {'bytes': ")
