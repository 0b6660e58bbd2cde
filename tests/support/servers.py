"""A server of HTTP on this machine, with its files in memory: tests read and write them."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import unquote, urlsplit

Files = dict[str, bytes]


@contextmanager
def served(*, writable: bool = True) -> Iterator[tuple[str, Files]]:
    """Context of a server; yields its URL, without a slash at the end, and its files by paths."""
    files: Files = {}

    class Handler(BaseHTTPRequestHandler):
        timeout = 20

        def _path(self) -> str:
            return unquote(urlsplit(self.path).path).lstrip("/")

        def _answer(self, code: int, body: bytes = b"", kind: str = "text/html") -> None:
            self.send_response(code)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(body)

        def do_GET(self) -> None:
            path = self._path()
            if path in files:
                self._answer(200, files[path], "application/octet-stream")
                return
            folder = f"{path.rstrip('/')}/" if path else ""
            inside = sorted(
                {name[len(folder) :].partition("/") for name in files if name.startswith(folder)}
            )
            if not inside:
                self._answer(404)
                return
            links = dict.fromkeys(f"{name}{slash}" for name, slash, _ in inside)
            self._answer(
                200, "".join(f'<a href="/{folder}{one}">{one}</a>' for one in links).encode()
            )

        do_HEAD = do_GET  # noqa: N815, the name that http.server looks for

        def do_PUT(self) -> None:
            data = self.rfile.read(int(self.headers["Content-Length"]))
            if not writable:
                self._answer(403)
                return
            files[self._path()] = data
            self._answer(201)

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}", files
    finally:
        server.shutdown()
        server.server_close()
        thread.join(10)
