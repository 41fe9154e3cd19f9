# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of all pages have in common."""
import json
import time

from png import rows_of

kSoftwareGl = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing"]
kNoGl = ["--disable-gpu", "--disable-webgl", "--disable-webgl2"]
kDesktop = (1000, 640)
kPhone = (360, 640)


class Checks:
    """Counts what was found wrong, and says what was found, and when."""

    def __init__(self):
        self.failed = 0
        self.begun = time.monotonic()

    def that(self, fine, words):
        self.failed += not fine
        print(f"{time.monotonic() - self.begun:5.1f} s  {'ok   ' if fine else 'WRONG'}  {words}", flush=True)


def picture_saver(folder):
    """A function save(name, page), which writes a screenshot if there is a folder for it."""
    def save(name, page):
        if folder:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{name}.png").write_bytes(page.screenshot())
    return save


def canvas_box(page, name="view"):
    """Where in the window [px] the object is shown: x, y, width, height."""
    return page.evaluate("(({x, y, width, height}) => [x, y, width, height])(document.getElementById('" + name + "').getBoundingClientRect())")


def canvas_of(page, name="view"):
    """Pixels of the picture of the object, at half its size."""
    return [pixel for row in rows_of(page.screenshot(canvas_box(page, name), 0.5)) for pixel in row]


def settle(page):
    """Waits until two frames were drawn."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")


def check_silence(checks, page, url):
    """Nothing was asked of the network, nothing was complained about, and nothing could be asked."""
    asked = [event["params"]["request"]["url"] for event in page.events if event["method"] == "Network.requestWillBeSent"]
    others = [one for one in asked if one != url and not one.startswith("data:")]
    checks.that(url in asked and not others, f"the page asks for nothing but itself {others or ''}")
    complaints = [event["params"] for event in page.events
                  if event["method"] == "Runtime.exceptionThrown"
                  or event["method"] == "Runtime.consoleAPICalled" and event["params"]["type"] in ("error", "warning", "assert")
                  or event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error"]
    checks.that(not complaints, f"the console is silent {json.dumps(complaints)[:600] if complaints else ''}")
    refused = page.evaluate("new Promise((done) => { document.addEventListener('securitypolicyviolation', (e) => done(e.violatedDirective));"
                            " fetch('https://example.invalid/').then(() => done('nobody'), () => setTimeout(done, 500, 'nobody')); })")
    checks.that(refused == "connect-src", f"what would ask the network is refused by {refused}")


def check_sentence(checks, page, url, words, save):
    """A page that cannot show the object says why."""
    page.set_size(*kDesktop)
    page.open(url)
    page.wait_until("!document.getElementById('message').hidden")
    said = page.evaluate("document.getElementById('message').innerText")
    visible = page.evaluate("document.getElementById('message').getClientRects().length > 0")
    save(words.lower(), page)
    checks.that(visible and words in said, f"it is said: {said!r}")
