"""Files are whole or absent: threads, processes, modes, links, devices, full disks, leftovers."""

from __future__ import annotations

import errno
import os
import re
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import meshes
import pytest
from killed import dead_process, left_of
from places import ROOT

import deltamesh
from deltamesh_formats import atomic, temporaries
from deltamesh_formats.atomic import found_at, write_file

posix = pytest.mark.skipif(os.name != "posix", reason="POSIX files")
not_root = pytest.mark.skipif(
    os.name == "posix" and os.geteuid() == 0, reason="root may write into any folder"
)
root = pytest.mark.skipif(
    os.name != "posix" or os.geteuid() != 0, reason="only root gives files to others"
)
full = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")

SHORT, LONG = b"short" * 50, b"a longer one" * 5000
MESHES = [deltamesh.from_arrays(*meshes.torus(9, 7)), deltamesh.from_arrays(*meshes.icosphere(2))]


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "out.dmesh"


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def fails_with(number: int) -> Callable[..., None]:
    def fail(*arguments: object) -> None:
        raise OSError(number, os.strerror(number))

    return fail


def no_links(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have a file system without hard links."""
    monkeypatch.setattr(os, "link", fails_with(errno.EPERM))


def meanwhile(monkeypatch: pytest.MonkeyPatch, action: Callable[[], object]) -> None:
    """Do something when all bytes are written and the file has not its name yet."""
    synchronize = os.fsync

    def later(descriptor: int) -> None:
        synchronize(descriptor)
        action()

    monkeypatch.setattr(os, "fsync", later)


# Many writers


def save(path: Path, which: int) -> None:
    deltamesh.save(path, MESHES[which], method="cartesian")


def write_mesh(path: Path, which: int) -> None:
    deltamesh.write_mesh(path, MESHES[which], "ply")


def write(path: Path, which: int) -> None:
    write_file(path, (SHORT, LONG)[which])


@pytest.mark.parametrize("writer", [save, write_mesh, write])
def test_threads_never_show_half_a_file(writer: Callable[[Path, int], None], target: Path) -> None:
    whole = []
    for which in (0, 1):
        writer(target, which)
        whole.append(target.read_bytes())
    end, errors = time.monotonic() + 1.5, []

    def repeat(which: int) -> None:
        try:
            while time.monotonic() < end:
                writer(target, which)
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=repeat, args=(which,)) for which in (0, 1, 0, 1)]
    for thread in threads:
        thread.start()
    seen = set()
    while any(thread.is_alive() for thread in threads):
        seen.add(target.read_bytes())
    for thread in threads:
        thread.join()
    assert not errors
    assert seen <= set(whole)
    assert target.read_bytes() in whole
    assert names(target.parent) == [target.name]


def test_processes_never_show_half_a_file(target: Path) -> None:
    code = (
        "import sys; from deltamesh_formats.atomic import write_file\n"
        "for _ in range(40): write_file(sys.argv[1], sys.argv[2].encode() * 50_000)"
    )
    write_file(target, b"0" * 50_000)
    processes = [subprocess.Popen([sys.executable, "-c", code, target, str(i)]) for i in range(3)]
    try:
        seen, end = set(), time.monotonic() + 60
        while any(process.poll() is None for process in processes):
            assert time.monotonic() < end
            seen.add(target.read_bytes())
    finally:
        for process in processes:
            process.kill()
            process.wait()
    assert [process.returncode for process in processes] == [0, 0, 0]
    assert seen <= {str(i).encode() * 50_000 for i in range(3)}
    assert names(target.parent) == [target.name]


@pytest.mark.parametrize("links", [True, False])
def test_one_writer_alone_makes_a_new_file(
    links: bool, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not links:
        no_links(monkeypatch)
    made, refused = [], []
    barrier = threading.Barrier(8)
    meanwhile(monkeypatch, lambda: barrier.wait(timeout=60))

    def create(number: int) -> None:
        try:
            write_file(target, b"%d" % number * 1000, overwrite=False)
            made.append(number)
        except FileExistsError:
            refused.append(number)

    threads = [threading.Thread(target=create, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert (len(made), len(refused)) == (1, 7)
    assert target.read_bytes() == b"%d" % made[0] * 1000
    assert names(target.parent) == [target.name]


# What exists


def test_what_exists_is_refused_before_any_work(
    target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target.write_bytes(b"precious")
    (target.parent / "folder").mkdir()
    monkeypatch.setattr(atomic, "_create", fails_with(errno.EIO))
    for path in (target, target.parent / "folder"):
        with pytest.raises(FileExistsError) as caught:
            write_file(path, SHORT, overwrite=False)
        assert caught.value.filename == str(path)
    assert target.read_bytes() == b"precious"


@pytest.mark.parametrize("links", [True, False])
def test_what_appears_in_the_last_moment_is_not_replaced(
    links: bool, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not links:
        no_links(monkeypatch)
    meanwhile(monkeypatch, lambda: target.write_bytes(b"precious"))
    with pytest.raises(FileExistsError) as caught:
        write_file(target, SHORT, overwrite=False)
    assert caught.value.filename == str(target)
    assert target.read_bytes() == b"precious"
    assert names(target.parent) == [target.name]
    write_file(target, SHORT)
    assert target.read_bytes() == SHORT


@posix
@pytest.mark.parametrize("links", [True, False])
def test_a_link_that_appears_is_not_replaced(
    links: bool, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not links:
        no_links(monkeypatch)
    meanwhile(monkeypatch, lambda: target.symlink_to("elsewhere"))
    with pytest.raises(FileExistsError):
        write_file(target, SHORT, overwrite=False)
    assert names(target.parent) == [target.name]
    assert target.is_symlink()


def test_the_reserved_name_is_given_up(target: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    no_links(monkeypatch)
    monkeypatch.setattr(os, "replace", fails_with(errno.EIO))
    with pytest.raises(OSError, match=r"out\.dmesh") as caught:
        write_file(target, SHORT, overwrite=False)
    assert caught.value.errno == errno.EIO
    assert not names(target.parent)


def test_a_reserved_name_that_somebody_writes_to_is_theirs(
    target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interfere(*arguments: object) -> None:
        target.write_bytes(b"precious")
        raise OSError(errno.EIO, "Input/output error")

    no_links(monkeypatch)
    monkeypatch.setattr(os, "replace", interfere)
    with pytest.raises(OSError, match=r"out\.dmesh"):
        write_file(target, SHORT, overwrite=False)
    assert target.read_bytes() == b"precious"


# Permissions


@posix
@pytest.mark.parametrize("kept", [0o604, 0o640, 0o444, 0o400])
@pytest.mark.parametrize("writer", [save, write_mesh, write])
def test_permissions_stay(kept: int, writer: Callable[[Path, int], None], target: Path) -> None:
    target.write_bytes(b"old")
    target.chmod(kept)
    previous = os.umask(0o077)
    try:
        writer(target, 0)
    finally:
        os.umask(previous)
    assert mode(target) == kept
    assert target.read_bytes() != b"old"


@posix
@pytest.mark.parametrize("overwrite", [True, False])
def test_a_new_file_has_what_the_umask_leaves(overwrite: bool, target: Path) -> None:
    previous = os.umask(0o027)
    try:
        write_file(target, SHORT, overwrite=overwrite)
    finally:
        os.umask(previous)
    assert mode(target) == 0o640
    assert target.stat().st_nlink == 1


@posix
def test_what_nobody_else_may_read_is_never_readable(
    target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target.write_bytes(b"secret")
    target.chmod(0o600)
    seen = []
    meanwhile(monkeypatch, lambda: seen.extend(map(mode, target.parent.iterdir())))
    create = os.open

    def opened(*arguments: object) -> int:
        descriptor = create(*arguments)  # type: ignore[arg-type]
        seen.append(stat.S_IMODE(os.fstat(descriptor).st_mode))
        return descriptor

    monkeypatch.setattr(os, "open", opened)
    write_file(target, SHORT)
    assert seen == [0o600, 0o600, 0o600]


@root
def test_root_leaves_files_to_their_owners(target: Path) -> None:
    target.write_bytes(b"old")
    target.chmod(0o640)
    os.chown(target, 1234, 4321)
    write_file(target, SHORT)
    found = target.stat()
    assert (found.st_uid, found.st_gid, mode(target)) == (1234, 4321, 0o640)


@posix
def test_a_file_system_without_permissions(target: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target.write_bytes(b"old")
    for function in ("fchmod", "fchown"):
        monkeypatch.setattr(os, function, fails_with(errno.EPERM))
    write_file(target, SHORT)
    assert target.read_bytes() == SHORT


# Links


@posix
@pytest.mark.parametrize("writer", [save, write_mesh, write])
@pytest.mark.parametrize("dangling", [True, False])
@pytest.mark.parametrize("relative", [True, False])
def test_a_link_stays_and_what_it_names_is_written(
    writer: Callable[[Path, int], None], dangling: bool, relative: bool, tmp_path: Path
) -> None:
    real, link = tmp_path / "store" / "real", tmp_path / "links" / "out.dmesh"
    chain = tmp_path / "links" / "chain"
    real.parent.mkdir()
    link.parent.mkdir()
    chain.symlink_to("../store/real" if relative else real)
    link.symlink_to("chain")
    if not dangling:
        real.write_bytes(b"old")
        real.chmod(0o604)
    writer(link, 0)
    assert os.readlink(link) == "chain"
    assert chain.is_symlink()
    assert not real.is_symlink()
    assert real.read_bytes() not in (b"", b"old")
    assert dangling or mode(real) == 0o604
    assert (names(real.parent), names(link.parent)) == (["real"], ["chain", "out.dmesh"])


@posix
def test_a_dangling_link_is_nothing_and_a_circle_is_an_error(tmp_path: Path) -> None:
    link, circle = tmp_path / "link", tmp_path / "circle"
    link.symlink_to("real")
    write_file(link, SHORT, overwrite=False)
    assert (tmp_path / "real").read_bytes() == SHORT
    with pytest.raises(FileExistsError):
        write_file(link, LONG, overwrite=False)
    circle.symlink_to("circle")
    with pytest.raises(OSError, match="circle") as caught:
        write_file(circle, SHORT)
    assert caught.value.errno == errno.ELOOP
    assert names(tmp_path) == ["circle", "link", "real"]


# Pipes and devices


@posix
@pytest.mark.parametrize("overwrite", [True, False])
def test_a_pipe_is_written_in_place(overwrite: bool, target: Path) -> None:
    os.mkfifo(target)
    command = [sys.executable, "-c", "import sys; print(len(open(sys.argv[1], 'rb').read()))"]
    with subprocess.Popen([*command, target], stdout=subprocess.PIPE) as reader:
        try:
            write_file(target, LONG, overwrite=overwrite)
            out, _ = reader.communicate(timeout=60)
        finally:
            reader.kill()
    assert int(out) == len(LONG)
    assert stat.S_ISFIFO(target.stat().st_mode)
    assert names(target.parent) == [target.name]


@posix
def test_devices_stay_devices() -> None:
    write_file("/dev/null", SHORT, overwrite=False)
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    assert found_at("/dev/null") == "stream"


@full
def test_a_full_device_is_an_error_of_it() -> None:
    for writer in (save, write_mesh, write):
        with pytest.raises(OSError, match="/dev/full") as caught:
            writer(Path("/dev/full"), 0)
        assert caught.value.errno == errno.ENOSPC
    assert stat.S_ISCHR(os.stat("/dev/full").st_mode)


@posix
@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "link"])
@pytest.mark.parametrize("to_file", [True, False])
def test_standard_output_by_a_name(name: str, to_file: bool, tmp_path: Path) -> None:
    if not os.path.exists("/dev/stdout"):
        pytest.skip("no /dev/stdout")
    os.symlink("/dev/stdout", tmp_path / "link")
    code = (
        "import os, sys; from deltamesh_formats.atomic import write_file\n"
        "os.write(1, b'before')\n"
        "write_file(sys.argv[1], b'the bytes', overwrite=False)\n"
        "os.write(1, b'after')"
    )
    with open(tmp_path / "printed", "wb") as file:
        done = subprocess.run(
            [sys.executable, "-c", code, name],
            stdout=file if to_file else subprocess.PIPE,
            cwd=tmp_path,
            timeout=60,
        )
    assert done.returncode == 0
    printed = (tmp_path / "printed").read_bytes() if to_file else done.stdout
    assert printed == b"beforethe bytesafter"
    assert names(tmp_path) == ["link", "printed"]


def test_folders_are_no_files(tmp_path: Path) -> None:
    assert [found_at(tmp_path), found_at(tmp_path / "new")] == ["other", "nothing"]
    with pytest.raises(OSError, match=re.escape(tmp_path.name)):
        write_file(tmp_path, SHORT)
    with pytest.raises(FileNotFoundError) as caught:
        write_file(tmp_path / "nowhere" / "x", SHORT)
    assert caught.value.filename == str(tmp_path / "nowhere" / "x")
    assert not names(tmp_path)


# Errors and interrupts


@pytest.mark.parametrize("overwrite", [True, False])
@pytest.mark.parametrize("function", ["open", "write", "fsync", "replace"])
def test_an_error_leaves_what_was_there(
    overwrite: bool, function: str, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if overwrite:
        target.write_bytes(b"old")
    elif function == "replace":
        no_links(monkeypatch)
    monkeypatch.setattr(os, function, fails_with(errno.ENOSPC))
    with pytest.raises(OSError, match=r"out\.dmesh") as caught:
        write_file(target, SHORT, overwrite=overwrite)
    monkeypatch.undo()
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(target))
    assert names(target.parent) == ([target.name] if overwrite else [])
    assert not overwrite or target.read_bytes() == b"old"


def test_a_disk_that_fills_up_while_bytes_are_written(
    target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put, taken = os.write, []

    def some(descriptor: int, data: memoryview) -> int:
        if sum(taken) > 1000:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        taken.append(put(descriptor, data[:300]))
        return taken[-1]

    target.write_bytes(b"old")
    monkeypatch.setattr(os, "write", some)
    with pytest.raises(OSError, match=r"out\.dmesh"):
        deltamesh.write_mesh(target, MESHES[0], "ply")
    assert taken == [300] * 4
    assert target.read_bytes() == b"old"
    assert names(target.parent) == [target.name]
    taken.clear()
    write_file(target, SHORT[:100])  # what fits is taken
    assert target.read_bytes() == SHORT[:100]


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, MemoryError])
def test_an_interrupt_leaves_what_was_there(
    error: type[BaseException], target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt() -> None:
        raise error

    target.write_bytes(b"old")
    meanwhile(monkeypatch, interrupt)
    for path in (target, target.with_name("new")):
        with pytest.raises(error):
            write_file(path, SHORT)
    assert target.read_bytes() == b"old"
    assert names(target.parent) == [target.name]


@not_root
@posix
def test_a_folder_that_must_not_be_written(target: Path) -> None:
    target.write_bytes(b"old")
    target.parent.chmod(0o500)
    try:
        with pytest.raises(PermissionError) as caught:
            write_file(target, SHORT)
    finally:
        target.parent.chmod(0o700)
    assert caught.value.filename == str(target)
    assert target.read_bytes() == b"old"


# Names


@pytest.mark.parametrize(
    "name", ["größe 山.dmesh", "a\u0301", "x" * 255, "ü" * 127 + "x", "-f", " "]
)
def test_names_of_any_kind_and_length(name: str, tmp_path: Path) -> None:
    for overwrite in (False, True):
        try:
            (tmp_path / name).touch()
            (tmp_path / name).unlink()
        except OSError:
            pytest.skip("the file system does not take the name itself")
        write_file(tmp_path / name, SHORT, overwrite=overwrite)
        assert (tmp_path / name).read_bytes() == SHORT
        assert len(names(tmp_path)) == 1


def test_temporary_names_are_short_and_each_its_own(tmp_path: Path) -> None:
    made = {temporaries.temporary_of(str(tmp_path / ("x" * 255))) for _ in range(100)}
    assert len(made) == 100
    for path in made:
        folder, name = os.path.split(path)
        assert folder == str(tmp_path)
        assert len(name) < 80
        assert temporaries._NAME.fullmatch(name)


# What killed processes leave


@posix
def test_a_killed_process_is_cleaned_up_after(target: Path) -> None:
    code = (
        "import os, sys, time; from deltamesh_formats.atomic import write_file\n"
        "os.fsync = lambda descriptor: (print('here', flush=True), time.sleep(60))\n"
        "write_file(sys.argv[1], b'half')"
    )
    with subprocess.Popen([sys.executable, "-c", code, target], stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == b"here\n"
            left = names(target.parent)
            write_file(target.with_name("other"), SHORT)  # the process is alive: the file stays
            assert names(target.parent) == [*left, "other"]
            process.send_signal(signal.SIGKILL)
        finally:
            process.kill()
        process.wait(timeout=60)
    temporaries._seen.clear()  # as a new process has it
    write_file(target.with_name("another"), SHORT)
    assert len(left) == 1
    assert names(target.parent) == ["another", "other"]


def test_a_folder_is_looked_through_once(target: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looked = []
    monkeypatch.setattr(temporaries, "_remove", looked.append)
    for name in ("a", "b", "c"):
        write_file(target.with_name(name), SHORT)
    assert looked == [str(target.parent)]


@posix
def test_only_what_is_certain_is_removed(target: Path) -> None:
    dead, long_ago = dead_process(), time.time() - 2 * temporaries._SECONDS
    gone = [left_of(target, dead), left_of(target, 1, machine="0" * 8)]
    os.utime(gone[1], (long_ago, long_ago))
    kept = [
        left_of(target, os.getpid()),
        left_of(target, os.getppid()),
        left_of(target, 10**30),
        left_of(target, dead, machine="0" * 8),
    ]
    for path in kept[:3]:
        os.utime(path, (long_ago, long_ago))
    named = left_of(target, dead)
    named.unlink()
    named.mkdir()
    linked = left_of(target, dead)
    linked.unlink()
    linked.symlink_to(kept[0])
    own = [".deltamesh-notes.tmp", f"{gone[0].name}.bak", f"x{gone[0].name}", gone[0].name.upper()]
    own += [gone[1].name.replace("-1-", "-0-"), f".{target.name}.{dead}.tmp"]
    for name in own:
        target.with_name(name).write_bytes(b"of the user")
        os.utime(target.with_name(name), (long_ago, long_ago))
    write_file(target, SHORT)
    expected = [path.name for path in (*kept, named, linked)] + [*own, target.name]
    assert names(target.parent) == sorted(expected)


@posix
def test_temporaries_of_outputs_are_removed_unless_written_here(target: Path) -> None:
    dead, other = dead_process(), target.with_name("other")
    left_of(target, dead)
    left_of(target, 1, machine="0" * 8)
    kept = [left_of(target, os.getpid()), left_of(other, dead)]
    temporaries.remove_temporaries([str(target), str(target.parent / "nowhere" / "x")])
    assert names(target.parent) == sorted(path.name for path in kept)
    for path in kept:
        path.unlink()


# One writer


def test_nothing_else_writes_files() -> None:
    folders = [
        ROOT / "src/deltamesh",
        ROOT / "formats/deltamesh_formats",
        ROOT / "cli/deltamesh_cli",
    ]
    writing = re.compile(
        r"\.write_(bytes|text)\(|os\.(replace|rename|link)\(|shutil|tempfile|open\([^()]*[\"'][wxa]b?"
    )
    found = {
        path.name
        for folder in folders
        for path in folder.rglob("*.py")
        if writing.search(path.read_text(encoding="utf-8"))
    }
    assert found == {"atomic.py"}
