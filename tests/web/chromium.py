# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium with one page, driven by the DevTools protocol over pipes: messages are JSON that ends with a NUL."""
import base64
import json
import os
import select
import signal
import subprocess
import tempfile
import time


class Failed(Exception):
    """Chromium did not do what it was asked to, or not in time."""


class Chromium:
    """Use it with `with`: it ends, with all of its processes, in any case.

    `deadline` is the time.monotonic() after which every call raises Failed.
    """

    def __init__(self, program, flags, deadline):
        self.deadline = deadline
        self.events = []
        self.session = None
        self._next = 0
        self._unread = b""
        self._profile = tempfile.TemporaryDirectory(prefix="palpate-chromium-", ignore_cleanup_errors=True)
        commands, self._write = os.pipe()
        self._read, answers = os.pipe()

        def give_pipes():  # Chromium reads commands from descriptor 3 and writes answers to 4
            commands_copy, answers_copy = os.dup(commands), os.dup(answers)
            os.dup2(commands_copy, 3)
            os.dup2(answers_copy, 4)

        self._process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--no-first-run", "--disable-dev-shm-usage", "--disable-extensions", "--disable-background-networking",
             "--hide-scrollbars", "--remote-debugging-pipe", f"--user-data-dir={self._profile.name}", *flags, "about:blank"],
            preexec_fn=give_pipes, pass_fds=(3, 4), start_new_session=True, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(answers)

    def __enter__(self):
        try:
            target = self.call("Target.createTarget", url="about:blank")["targetId"]
            self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                self.call(f"{domain}.enable")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        try:
            os.killpg(self._process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self._process.wait()
        os.close(self._write)
        os.close(self._read)
        self._profile.cleanup()

    def _receive(self):
        while b"\0" not in self._unread:
            left = self.deadline - time.monotonic()
            if left <= 0 or not select.select([self._read], [], [], left)[0]:
                raise Failed("Chromium did not answer in time")
            got = os.read(self._read, 1 << 20)
            if not got:
                raise Failed("Chromium ended")
            self._unread += got
        message, self._unread = self._unread.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        """The result of one command; events that come meanwhile are kept."""
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        left = json.dumps(message).encode() + b"\0"
        while left:
            left = left[os.write(self._write, left):]
        while True:
            answer = self._receive()
            if answer.get("id") == self._next:
                if "error" in answer:
                    raise Failed(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def evaluate(self, expression):
        """The value of a JavaScript expression, as JSON has it; promises are awaited."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise Failed(f"{expression[:80]}: {details.get('exception', {}).get('description', details['text'])}")
        return answer["result"].get("value")

    def wait_until(self, expression):
        """Whether the expression becomes true before the deadline."""
        while time.monotonic() < self.deadline:
            if self.evaluate(expression):
                return True
            time.sleep(0.03)
        return False

    def open(self, url):
        """Opens a page and waits until it is loaded."""
        self.call("Page.navigate", url=url)
        if not self.wait_until(f"document.readyState === 'complete' && location.href === {json.dumps(url)}"):
            raise Failed(f"{url} was not loaded in time")

    def screenshot(self, box=None, scale=1):
        """A PNG image of the window, or of a box (x, y, width, height) [px] of it."""
        clip = {"clip": dict(zip(("x", "y", "width", "height"), box), scale=scale)} if box else {}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **clip)["data"])

    def set_size(self, width, height, phone=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        self.call("Emulation.setTouchEmulationEnabled", enabled=phone)

    def mouse(self, kind, place, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], **more)

    def touch(self, kind, places):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in places])

    def key(self, kind, code, key, number):
        self.call("Input.dispatchKeyEvent", type=kind, code=code, key=key, windowsVirtualKeyCode=number)
