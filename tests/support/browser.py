"""Browser of the tests: Chromium without a window, steered by ChromeDriver (W3C WebDriver)."""

from __future__ import annotations

import json
import shutil
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import children

# All that it would fetch is refused, too: a page that needs a network fails here.
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1100,700",
    "--proxy-server=127.0.0.1:9",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)
# WebGL by software.
DRAWING = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SECONDS = 60.0


def chromium() -> tuple[str, str] | None:
    """Return the commands of Chromium and of its driver, None where they are not installed."""
    found = shutil.which("chromium"), shutil.which("chromedriver")
    return (found[0], found[1]) if found[0] and found[1] else None


class Browser:
    """Session of a browser.

    Parameters
    ----------
    address : str
        Of the driver.
    capabilities : dict
    """

    def __init__(self, address: str, capabilities: dict[str, Any]) -> None:
        self.address = address
        wanted = {"capabilities": {"alwaysMatch": capabilities}}
        self.session = self.ask("POST", "/session", wanted)["sessionId"]

    def ask(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
        """Send a command; return the value of the answer."""
        data = None if method != "POST" else json.dumps(body or {}).encode()
        head = {"Content-Type": "application/json"}
        request = urllib.request.Request(self.address + path, data, head, method=method)
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(request, timeout=SECONDS) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(json.load(error)["value"]["message"]) from None

    def of_session(self, method: str, path: str, **body: Any) -> Any:
        """Send a command of the session."""
        return self.ask(method, f"/session/{self.session}{path}", body)

    def open(self, page: Path) -> None:
        """Open a page from a file, and wait until it has opened what it holds."""
        self.of_session("POST", "/url", url=page.resolve().as_uri())
        self.wait("return document.body.dataset.state === 'ready'")

    def run(self, script: str, *arguments: Any) -> Any:
        """Return what a script returns."""
        return self.of_session("POST", "/execute/sync", script=script, args=list(arguments))

    def wait(self, script: str) -> Any:
        """Return what a script returns, once that is true."""
        end = time.monotonic() + SECONDS
        while not (found := self.run(script)):
            assert time.monotonic() < end, f"never: {script}; {self.run(MESSAGES)}"
            time.sleep(0.05)
        return found

    def press(self, key: str) -> None:
        """Press a key."""
        keys = [{"type": kind, "value": key} for kind in ("keyDown", "keyUp")]
        actions = [{"type": "key", "id": "keyboard", "actions": keys}]
        self.of_session("POST", "/actions", actions=actions)

    def pointer(self, *actions: dict[str, Any], kind: str = "mouse") -> None:
        """Do something with the pointer."""
        source = {"type": "pointer", "id": kind, "parameters": {"pointerType": kind}}
        self.of_session("POST", "/actions", actions=[{**source, "actions": list(actions)}])

    def log(self) -> list[str]:
        """Return the errors that the page has written to its console."""
        entries = self.of_session("POST", "/se/log", type="browser")
        return [one["message"] for one in entries if one["level"] == "SEVERE"]


MESSAGES = "return document.querySelector('#message')?.textContent"


@contextmanager
def started(profile: Path, *flags: str) -> Iterator[Browser]:
    """Start a browser, which ends with the `with`.

    Parameters
    ----------
    profile : Path
        A new folder.
    *flags : str
        Further flags.
    """
    found = chromium()
    assert found is not None
    binary, driver = found
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    options = {"binary": binary, "args": [*FLAGS, *flags, f"--user-data-dir={profile}"]}
    capabilities = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
    with children.started([driver, f"--port={port}"]):
        address = f"http://127.0.0.1:{port}"
        _wait_for(address)
        browser = Browser(address, capabilities)
        try:
            yield browser
        finally:
            browser.of_session("DELETE", "")


def _wait_for(address: str) -> None:
    """Wait until the driver answers."""
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    end = time.monotonic() + SECONDS
    while True:
        try:
            opener.open(f"{address}/status", timeout=1).close()
            return
        except OSError:
            assert time.monotonic() < end, "the driver does not answer"
            time.sleep(0.05)
