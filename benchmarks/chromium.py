"""A Chromium of this machine, driven by its DevTools protocol over two pipes; nothing else is needed for it.

with Chromium() as browser:
    page = browser.open("file:///home.html")
    print(page.run("document.title"))
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--hide-scrollbars", "--remote-debugging-pipe"),
)

# The browser reads from descriptor 3 and writes to 4, wherever they are here.
_WIRING = """
import fcntl, os, sys
reads, writes = (fcntl.fcntl(int(number), fcntl.F_DUPFD, 10) for number in sys.argv[1:3])
os.dup2(reads, 3)
os.dup2(writes, 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


def find_chromium() -> str | None:
    """Return the path of the browser, or None if there is none."""
    return next((found for name in _NAMES if (found := shutil.which(name))), None)


class Chromium:
    """A browser with a new profile, which ends with the context."""

    def __enter__(self) -> Chromium:
        path = find_chromium()
        if path is None:
            raise RuntimeError("there is no Chromium on this machine")
        self._stack = contextlib.ExitStack()
        self.folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
        reads, self._out = os.pipe()
        self._in, writes = os.pipe()
        command = [path, *_FLAGS, f"--user-data-dir={self.folder / 'profile'}", "about:blank"]
        command = [sys.executable, "-c", _WIRING, str(reads), str(writes), *command]
        nowhere = subprocess.DEVNULL
        self._process = subprocess.Popen(command, pass_fds=(reads, writes), stdout=nowhere, stderr=nowhere)
        os.close(reads)
        os.close(writes)
        self._left, self._number = b"", 0
        self.events: list[dict] = []
        (self.folder / "files").mkdir()
        self.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.folder / "files"))
        return self

    def __exit__(self, *error) -> None:
        with contextlib.suppress(Exception):
            self.call("Browser.close", timeout=5)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5)
        self._process.kill()
        self._process.wait()
        os.close(self._in)
        os.close(self._out)
        self._stack.close()

    def call(self, method: str, session: str | None = None, timeout: float = 30, **parameters) -> dict:
        """Send a command and return what it answers; events that come first are kept in ``events``."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + timeout
        while True:
            answer = self._read(end)
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def wait(self, method: str, session: str, timeout: float = 30) -> dict:
        """Return the first event of a kind, taken out of those that are kept."""
        end = time.monotonic() + timeout
        while True:
            for event in self.events:
                if event.get("method") == method and event.get("sessionId") == session:
                    self.events.remove(event)
                    return event["params"]
            self.events.append(self._read(end))

    def _read(self, end: float) -> dict:
        while b"\0" not in self._left:
            ready, _, _ = select.select([self._in], [], [], max(0.0, end - time.monotonic()))
            part = os.read(self._in, 1 << 20) if ready else b""
            if not part:
                raise TimeoutError("the browser does not answer")
            self._left += part
        message, _, self._left = self._left.partition(b"\0")
        return json.loads(message)

    def open(self, url: str, width: int = 1280, height: int = 800, dark: bool = False) -> Page:
        """Open a page and wait until it has loaded."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session, target)
        for domain in ("Page", "Runtime", "Network", "Log"):
            page.call(f"{domain}.enable")
        page.resize(width, height)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        page.call("Emulation.setEmulatedMedia", features=[scheme])
        page.go(url)
        return page


class Page:
    """A tab of the browser."""

    def __init__(self, browser: Chromium, session: str, target: str):
        self.browser, self.session, self.target = browser, session, target

    def call(self, method: str, **parameters) -> dict:
        """Send a command to the tab."""
        return self.browser.call(method, self.session, **parameters)

    def go(self, url: str) -> None:
        """Go to another address and wait until it has loaded."""
        self.call("Page.navigate", url=url)
        self.browser.wait("Page.loadEventFired", self.session)

    def run(self, script: str) -> Any:
        """Return what a script says, as plain data; a promise is waited for."""
        options = {"returnByValue": True, "awaitPromise": True}
        answer = self.call("Runtime.evaluate", expression=script, **options)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", str(answer)))
        return answer["result"].get("value")

    def resize(self, width: int, height: int) -> None:
        """Give the window another size."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def press(self, key: str) -> None:
        """Press a key and let it go."""
        codes = {"Tab": 9, "Enter": 13, "End": 35, "Home": 36, "ArrowLeft": 37, "ArrowRight": 39, "PageUp": 33, "PageDown": 34}
        options: dict[str, Any] = {"key": key, "code": key, "windowsVirtualKeyCode": codes[key]}
        if key == "Enter":
            options["text"] = "\r"
        self.call("Input.dispatchKeyEvent", type="keyDown", **options)
        self.call("Input.dispatchKeyEvent", type="keyUp", **options)

    def move(self, x: float, y: float) -> None:
        """Move the pointer."""
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def click(self, x: float, y: float) -> None:
        """Move the pointer to a place of the window and click."""
        self.move(x, y)
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def screenshot(self, file: str | Path) -> None:
        """Write a picture of the window."""
        Path(file).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    @property
    def requests(self) -> list[str]:
        """The addresses that the tab has asked for, the page itself included."""
        self.run("0")  # what has happened until now has been told when this is answered
        sent = [event["params"] for event in self._events("Network.requestWillBeSent")]
        return [event["request"]["url"] for event in sent]

    @property
    def complaints(self) -> list[str]:
        """Errors and warnings of the tab's scripts, and what its policy refused."""
        self.run("0")
        thrown = [event["params"]["exceptionDetails"].get("text", "") for event in self._events("Runtime.exceptionThrown")]
        said = [event["params"] for event in self._events("Runtime.consoleAPICalled")]
        logged = [event["params"]["entry"] for event in self._events("Log.entryAdded")]
        said = [str(one["args"]) for one in said if one["type"] in ("error", "warning", "assert")]
        return [*thrown, *said, *(entry["text"] for entry in logged if entry["level"] in ("error", "warning"))]

    def _events(self, method: str) -> list[dict]:
        return [one for one in self.browser.events if one.get("method") == method and one.get("sessionId") == self.session]

    def downloaded(self, name: str, timeout: float = 10) -> bytes:
        """Return a file that the tab has saved under a name, once it is there."""
        file, end = self.browser.folder / "files" / name, time.monotonic() + timeout
        while not file.exists():
            if time.monotonic() > end:
                raise TimeoutError(f"there is no {name} among {sorted(path.name for path in file.parent.iterdir())}")
            time.sleep(0.02)
        return file.read_bytes()

    def close(self) -> None:
        """Close the tab."""
        self.browser.call("Target.closeTarget", targetId=self.target)
