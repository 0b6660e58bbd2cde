"""Files that systems have for their programs fit this one: docs/system.md, and what it is about."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import sys
import tomllib
from configparser import ConfigParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import children
import click
import pytest
from documents import script
from places import GOLDEN, ROOT

from deltamesh_cli.program import COMMANDS, cli
from deltamesh_formats.container.layout import MAGIC
from deltamesh_formats.meshfiles.formats import EXTENSIONS
from deltamesh_formats.wrappers import wrapped

PAGE = ROOT / "docs" / "system.md"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"
TOP = click.Context(cli, info_name="deltamesh", **cli.context_settings)


def block(name: str) -> str:
    return script(".ci/readme_block.py").block(name, PAGE)


def yaml_of(text: str) -> Any:
    return pytest.importorskip("yaml").safe_load(text)


def parsed(command: str) -> tuple[str, dict[str, Any]]:
    """The name and the parameters of a command line, which the program has to accept."""
    program, name, *arguments = shlex.split(command)
    assert program in PROJECT["scripts"]
    found = cli.get_command(TOP, name)
    assert found is not None
    return name, found.make_context(name, arguments, parent=TOP).params


def test_every_block_is_run_here() -> None:
    blocks = re.findall(r"<!-- run: ([\w-]+) -->\n```", PAGE.read_text(encoding="utf-8"))
    assert blocks == ["man", "mime", "site"]
    here = Path(__file__).read_text(encoding="utf-8")
    assert all(f'block("{name}")' in here for name in blocks)


# ---- Man pages ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("click_man")
    folder = tmp_path_factory.mktemp("man")
    command = shlex.split(block("man").splitlines()[0])
    assert command[0] == "python"
    done = children.run(
        [sys.executable, *command[1:-1], folder],
        cwd=ROOT,
        env={**os.environ, "SOURCE_DATE_EPOCH": "86400"},
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_there_is_a_man_page_of_each_command(pages: Path) -> None:
    names = ["deltamesh", *(f"deltamesh-{name}" for name in COMMANDS)]
    assert sorted(path.stem for path in pages.iterdir()) == sorted(names)
    for path in pages.iterdir():
        text = path.read_text(encoding="utf-8")
        assert '"1970-01-02"' in text.splitlines()[0]
        for section in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT CODES"):
            assert f"\n.SH {section}\n" in text


@pytest.mark.parametrize("name", COMMANDS)
def test_a_man_page_has_every_option_and_example(pages: Path, name: str) -> None:
    text = (pages / f"deltamesh-{name}.1").read_text(encoding="utf-8").replace(r"\-", "-")
    command = cli.get_command(TOP, name)
    assert command is not None
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            assert max(parameter.opts, key=len) in text
    examples = [line for line in (command.epilog or "").splitlines() if "deltamesh " in line]
    assert examples
    for example in examples:
        assert example.strip().replace("\\", r"\e") in text


def test_man_pages_are_read_without_a_warning(pages: Path) -> None:
    if shutil.which("groff") is None:
        pytest.skip("no groff")
    for path in sorted(pages.iterdir()):
        done = children.run(["groff", "-man", "-Tutf8", "-ww", "-z", path], text=True)
        assert (done.returncode, done.stderr) == (0, ""), path.name


def test_the_commands_of_the_page_show_a_man_page(tmp_path: Path) -> None:
    pytest.importorskip("click_man")
    if shutil.which("man") is None or shutil.which("bash") is None:
        pytest.skip("no man")
    (tmp_path / "cli").symlink_to(ROOT / "cli")
    prelude = 'python() { "$PYTHON" "$@"; }\n'
    environment = {**os.environ, "PYTHON": sys.executable, "MANPAGER": "cat", "MANWIDTH": "80"}
    call = ["bash", "-euc", prelude + block("man")]
    done = children.run(call, cwd=tmp_path, env=environment, text=True)
    assert done.returncode == 0, done.stderr
    assert "deltamesh encode [OPTIONS] IN [OUT]" in re.sub(".\b", "", done.stdout)


# ---- The kind of file ---------------------------------------------------------------------------


def test_the_magic_and_the_name_are_those_of_the_format() -> None:
    kind = ElementTree.parse(ROOT / "packaging" / "deltamesh.xml").find(f"{MIME}mime-type")
    assert kind is not None
    match = kind.find(f"{MIME}magic/{MIME}match")
    glob = kind.find(f"{MIME}glob")
    assert match is not None
    assert glob is not None
    assert (match.get("type"), match.get("offset")) == ("string", "0")
    written = str(match.get("value")).encode().decode("unicode_escape").encode("latin-1")
    assert written == MAGIC
    files = sorted(GOLDEN.glob("*.dmesh"))
    assert files
    assert all(path.read_bytes().startswith(written) for path in files)
    assert not any(extension in "dmesh" for extension in EXTENSIONS)
    assert glob.get("pattern") == "*.dmesh"


def test_a_desktop_knows_a_file_by_its_bytes_and_by_its_name(tmp_path: Path) -> None:
    for program in ("update-mime-database", "xdg-mime", "bash"):
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")
    data = (ROOT / "benchmarks" / "meshes" / "torus.ply").read_bytes()
    whole = next(iter(sorted(GOLDEN.glob("*.dmesh")))).read_bytes()
    for name, content in {"scan.dmesh": whole, "noname": whole, "torus.ply": data}.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "packaging").mkdir()
    shutil.copy(ROOT / "packaging" / "deltamesh.xml", tmp_path / "packaging")
    # The data of the desktop are in these folders alone; xdg-mime asks `file` where it knows none.
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path / "share"), "HOME": str(tmp_path)}
    environment |= {"XDG_DATA_DIRS": str(tmp_path / "share")}
    done = children.run(["bash", "-euc", block("mime")], cwd=tmp_path, env=environment, text=True)
    assert done.returncode == 0, done.stderr
    magic = (tmp_path / "share" / "mime" / "magic").read_bytes()
    assert b"[80:model/x-deltamesh]\n>0=\x00\x08" + MAGIC in magic
    globs = (tmp_path / "share" / "mime" / "globs2").read_text()
    assert "50:model/x-deltamesh:*.dmesh" in globs
    if shutil.which("gio") or shutil.which("mimetype"):
        assert done.stdout.strip() == "model/x-deltamesh"


def test_a_file_manager_draws_a_thumbnail(tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    parser = ConfigParser(interpolation=None)
    parser.read(ROOT / "packaging" / "deltamesh.thumbnailer")
    entry = parser["Thumbnailer Entry"]
    kind = ElementTree.parse(ROOT / "packaging" / "deltamesh.xml").find(f"{MIME}mime-type")
    assert kind is not None
    assert entry["MimeType"] == f"{kind.get('type')};"
    shutil.copy(GOLDEN / "cartesian-1-bit.dmesh", tmp_path / "scan.dmesh")
    places = {"%i": "scan.dmesh", "%o": "thumbnail.png", "%s": "64"}
    program, *words = (places.get(word, word) for word in entry["Exec"].split())
    assert program == entry["TryExec"] == "deltamesh"
    call = [sys.executable, "-m", "deltamesh_cli", *words]
    for _ in range(2):  # the second time, there is one
        done = children.run(call, cwd=tmp_path, env=dict(os.environ), text=True)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "thumbnail.png").read_bytes().startswith(b"\x89PNG")


# ---- pre-commit, the action, the container ------------------------------------------------------


def hooks() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = yaml_of((ROOT / ".pre-commit-hooks.yaml").read_text())
    return found


def test_hooks_are_commands_of_the_program() -> None:
    by_id = {one["id"]: one for one in hooks()}
    assert set(by_id) == {"dmesh-intact", "dmesh-rates"}
    for one in by_id.values():
        assert {"id", "name", "entry", "language", "files", "description"} <= set(one)
        assert one["language"] == "python"
    intact, rates = by_id["dmesh-intact"], by_id["dmesh-rates"]
    assert parsed(f"{intact['entry']} a.dmesh b.dmesh")[0] == "test"
    name, given = parsed(shlex.join([*shlex.split(rates["entry"]), *rates["args"]]))
    assert (name, given["sources"], given["recursive"]) == ("bench", ("meshes",), True)
    assert rates["pass_filenames"] is False
    for path, is_taken in {"a.dmesh": True, "b/a.dmesh.zst": True, "dmesh": False}.items():
        assert bool(re.search(intact["files"], path)) == is_taken
    for extension in EXTENSIONS:
        assert re.search(rates["files"], f"meshes/A.{extension.upper()}")
    assert re.search(rates["files"], "rates.csv")
    assert not re.search(rates["files"], "notes.txt")


def test_the_hook_tells_whole_files_from_damaged_ones(tmp_path: Path) -> None:
    (intact,) = (one for one in hooks() if one["id"] == "dmesh-intact")
    whole = next(iter(sorted(GOLDEN.glob("*.dmesh")))).read_bytes()
    (tmp_path / "a.dmesh").write_bytes(whole)
    (tmp_path / "b.dmesh.zst").write_bytes(wrapped("b.zst", whole))
    (tmp_path / "c.dmesh").write_bytes(whole[:-1])
    _, name = shlex.split(intact["entry"])
    for files, code in ((["a.dmesh", "b.dmesh.zst"], 0), (["a.dmesh", "c.dmesh"], 3)):
        done = children.run([sys.executable, "-m", "deltamesh_cli", name, *files], cwd=tmp_path)
        assert done.returncode == code


def test_the_configuration_of_the_page_names_the_hooks() -> None:
    text = PAGE.read_text(encoding="utf-8")
    (example,) = re.findall(r"^```yaml\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    (repository,) = yaml_of(example)["repos"]
    assert [one["id"] for one in repository["hooks"]] == [one["id"] for one in hooks()]
    (rates,) = (one for one in hooks() if one["id"] == "dmesh-rates")
    assert repository["hooks"][1]["args"] == rates["args"]


def test_the_action_compares_with_a_table(tmp_path: Path) -> None:
    action = yaml_of((ROOT / "action.yml").read_text())
    inputs, steps = action["inputs"], action["runs"]["steps"]
    assert action["runs"]["using"] == "composite"
    used = set(re.findall(r"inputs\.([\w-]+)", str(steps)))
    assert used == set(inputs)
    assert all({"shell", "run"} <= set(step) for step in steps if "uses" not in step)
    minor = int(inputs["python-version"]["default"].split(".")[1])
    assert minor >= int(PROJECT["requires-python"].split(".")[1])
    for step in steps:  # nothing that a caller gives becomes a part of a script
        assert "${{" not in step.get("run", "")
    last = steps[-1]
    if shutil.which("bash") is None:
        pytest.skip("no bash")
    (tmp_path / "meshes" / "deep").mkdir(parents=True)
    shutil.copy(ROOT / "benchmarks" / "meshes" / "torus.ply", tmp_path / "meshes" / "deep")
    defaults = {
        variable: inputs[re.findall(r"inputs\.([\w-]+)", value)[0]]["default"]
        for variable, value in last["env"].items()
    }
    prelude = 'deltamesh() { "$PYTHON" -m deltamesh_cli "$@"; }\n'
    environment = {**os.environ, "PYTHON": sys.executable, **defaults}

    def bash(code: str) -> int:
        call = ["bash", "-euo", "pipefail", "-c", prelude + code]
        return children.run(call, cwd=tmp_path, env=environment, text=True).returncode

    assert bash("deltamesh bench meshes -r --method highpass --bits 6 --save rates.csv") == 0
    assert bash(last["run"]) == 0
    table = tmp_path / "rates.csv"
    heading, row = table.read_text().splitlines()
    at = heading.split(",").index("bytes")
    cells = row.split(",")
    cells[at] = str(int(cells[at]) // 2)
    table.write_text(f"{heading}\n{','.join(cells)}\n")
    assert bash(last["run"]) == 4


def test_the_page_on_ci_gives_inputs_that_the_action_has() -> None:
    text = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    _, example = re.findall(r"^```yaml\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    (step,) = (one for one in yaml_of(example)["jobs"]["rates"]["steps"] if "with" in one)
    inputs = yaml_of((ROOT / "action.yml").read_text())["inputs"]
    assert step["with"].items() <= {name: one["default"] for name, one in inputs.items()}.items()
    listed = re.findall(r"Its inputs are (.*?)\.", text, re.DOTALL)[0]
    assert re.findall(r"`([\w-]+)`", listed) == list(inputs)


def test_the_image_is_built_of_what_is_there() -> None:
    lines = re.sub(r"\\\n", "", (ROOT / "Dockerfile").read_text(encoding="utf-8")).splitlines()
    steps = [line.split(None, 1) for line in lines if line and not line.startswith("#")]
    assert steps[0][0] == "FROM"
    images = [text for word, text in steps if word == "FROM"]
    minors = {int(text.split(":3.")[1].split("-")[0]) for text in images}
    assert min(minors) >= int(PROJECT["requires-python"].split(".")[1])
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    copied = [text.split()[:-1] for word, text in steps if word == "COPY" and "--from" not in text]
    for path in (one for some in copied for one in some):
        assert (ROOT / path).exists()
        assert f"!{path}" in ignored
    build = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]
    needed = {Path(path).parts[0] for path in build["targets"]["wheel"]["packages"]}
    needed |= {Path(path).parts[0] for path in build["targets"]["wheel"]["shared-data"]}
    needed |= {"pyproject.toml", PROJECT["readme"], *PROJECT["license-files"]}
    needed.add(build["targets"]["wheel"]["hooks"]["custom"]["path"])
    assert {one for some in copied for one in some} == needed
    extras = re.findall(r"\[([\w,]+)\]", " ".join(text for word, text in steps if word == "RUN"))
    assert len(extras) == 2
    named = {name for one in extras for name in one.split(",")}
    assert named <= set(PROJECT["optional-dependencies"])
    (entry,) = (text for word, text in steps if word == "ENTRYPOINT")
    assert re.findall(r'"(.*?)"', entry) == list(PROJECT["scripts"])


# ---- The site -----------------------------------------------------------------------------------


def test_the_site_has_every_page_and_no_link_leads_nowhere(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    command = shlex.split(block("site"))
    assert command[:3] == ["mkdocs", "build", "--strict"]
    done = children.run(
        [sys.executable, "-m", *command[:-1], tmp_path / "site"],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        text=True,
    )
    assert done.returncode == 0, done.stderr
    pages = {path.parent.name for path in (tmp_path / "site").rglob("index.html")} - {"site"}
    docs = {path.stem for path in (ROOT / "docs").glob("*.md")}
    hooks = script(".ci/site_hooks.py")
    assert pages == docs | {Path(name).stem for name in hooks.PAGES} - {"index"}
    nav = re.findall(r": ([\w-]+)\.md$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    assert sorted(nav) == sorted(pages | {"index"})
    first = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert 'href="format/"' in first
    assert 'href="batch/#files-at-urls"' in first
    assert (tmp_path / "site" / "license.txt").read_text() == (ROOT / "LICENSE").read_text()


def test_a_link_that_leads_nowhere_fails_the_build(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    names = ["docs", ".ci", "mkdocs.yml"]
    names += [*script(".ci/site_hooks.py").PAGES.values(), "LICENSE"]
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tmp_path / name)
    with (tmp_path / "README.md").open("a") as page:
        page.write("\n[nowhere](docs/nowhere.md)\n")
    done = children.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", tmp_path / "site"],
        cwd=tmp_path,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        text=True,
    )
    assert done.returncode == 1
    assert "nowhere.md" in done.stderr
