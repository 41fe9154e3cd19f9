#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Opens a page of `palpate export --html` in a headless Chromium and checks it.

The forces of the page must be those that `palpate play` wrote for the same trajectory; the object must be drawn, and must be
pressed by mouse, pen, finger, key and gamepad; nothing may be asked of the network; without WebGL2, and with a damaged model, a sentence must
say so. Ends with status 0 if all is well, with 1 and words if not, and in any case before kSeconds.
"""
import argparse
import base64
import csv
import gzip
import json
import math
import re
import sys
import tempfile
import time
from pathlib import Path

from chromium import Chromium, Failed
from page_checks import (Checks, canvas_box, canvas_of, check_sentence, check_silence, kDesktop, kNoGl, kPhone, kSoftwareGl,
                         picture_saver, settle)

kSeconds = 240         # for everything, on a machine that is busy with other work
kForceTolerance = 1e-9  # [N] the same program on another processor: its sums are rounded in another order
kSmall = (500, 400)     # [px] of the window where many frames are waited for: software draws them
kSameFrames = 6        # in each of which the force changes by less than kSameShare when the tool is nearly at rest
kSameShare = 0.03
kTurnFrames = 6        # pairs of frames in which a stick turns the view
kStates = ["free", "stick", "slip"]
kFeels = "Number(document.getElementById('newtons').textContent) > 0"
kFree = "document.getElementById('state').dataset.state === 'free' && " \
        "Number(document.getElementById('newtons').textContent) === 0"


def is_surface(pixel):
    """The object is drawn in warm tones; the backdrop and everything else on the page is grey or blue."""
    return pixel[0] > pixel[2] + 15


def middle_of_object(page):
    """The middle of the picture, which shows the object."""
    x, y, width, height = canvas_box(page)
    return x + width / 2, y + height / 2


def check_forces(checks, page, folder):
    """The trace is what the same trajectory gives in C++."""
    with open(folder / "trace.csv", newline="") as file:
        trace = list(csv.DictReader(file))
    tools = [float(row[axis]) for row in trace for axis in "xyz"]
    played = page.evaluate(
        f"(({{states, forces, contacts}}) => [[...states], [...forces], [...contacts]])(palpate.play(new Float64Array({json.dumps(tools)})))")
    states, forces, contacts = played
    touched = sum(row["state"] != "free" for row in trace)
    checks.that(len(trace) == len(states) and touched > len(trace) // 10,
                f"{len(states)} ticks are played, {len(trace)} are in the trace, {touched} of them touch")
    wrong = sum(kStates[state] != row["state"] for state, row in zip(states, trace))
    checks.that(wrong == 0, f"{wrong} of the states differ from the trace")

    def largest(values, names):
        """The largest difference; a value that is not a number (null in JSON) is as wrong as can be."""
        recorded = [float(row[name]) for row in trace for name in names]
        return max((math.inf if a is None else abs(a - b) for a, b in zip(values, recorded)), default=math.inf)

    error = largest(forces, ("fx", "fy", "fz"))
    checks.that(error <= kForceTolerance, f"forces are within {error:.2g} N of the trace")
    error = largest(contacts, ("cx", "cy", "cz"))
    checks.that(error <= 1e-6, f"contacts are within {error:.2g} mm of the trace")


def check_desktop(checks, page, save):
    page.set_size(*kDesktop)
    settle(page)
    save("desktop", page)
    canvas = canvas_of(page)
    seen = [pixel for pixel in canvas if is_surface(pixel)]
    share = len(seen) / len(canvas)
    checks.that(0.05 < share < 0.9 and len(set(seen)) > 100,
                f"the object fills {share:.0%} of its picture, with {len(set(seen))} shades")

    x, y = middle_of_object(page)
    page.mouse("mouseMoved", (x, y))
    page.mouse("mousePressed", (x, y), button="left", buttons=1, clickCount=1)
    checks.that(page.wait_until(kFeels), "a press with the mouse is felt")
    for i in range(1, 4):
        page.mouse("mouseMoved", (x + 20 * i, y - 10 * i), button="left", buttons=1)
    settle(page)
    checks.that(page.evaluate("['stick', 'slip'].includes(document.getElementById('state').dataset.state)"),
                "a drag sticks or slips: " + page.evaluate("document.getElementById('state').innerText").replace("\n", " "))
    save("desktop-pressed", page)
    changed = sum(sum(abs(a - b) for a, b in zip(*pair)) > 24 for pair in zip(canvas, canvas_of(page)))
    checks.that(changed > len(canvas) // 500, f"the press changes {changed} pixels of the picture")
    page.mouse("mouseReleased", (x + 60, y - 30), button="left")
    checks.that(page.wait_until(kFree), "after the release nothing is felt")

    page.key("keyDown", "Space", " ", 32)
    checks.that(page.wait_until(kFeels), "the space key presses")
    page.key("keyUp", "Space", " ", 32)
    checks.that(page.wait_until(kFree), "and lets go")
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    settle(page)
    save("desktop-dark", page)
    dark = page.evaluate("getComputedStyle(document.getElementById('panel')).backgroundColor")
    checks.that(max(map(int, re.findall(r"\d+", dark))) < 80, f"the dark scheme is dark: {dark}")
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])


def settled_newtons(page):
    """The force [N] when it is felt and hardly changes from frame to frame: on a busy machine frames are few, and the tool sinks in slowly."""
    page.wait_until(kFeels)
    return page.evaluate("""new Promise((done) => {
        let before = -1, same = 0;
        const look = () => {
            const now = Number(document.getElementById('newtons').textContent);
            same = Math.abs(now - before) <= %g * now ? same + 1 : 0;
            before = now;
            if (same >= %d) done(now); else requestAnimationFrame(look);
        };
        look();
    })""" % (kSameShare, kSameFrames))


def check_pen(checks, page):
    """A pen presses as deep as its pressure says."""
    x, y = middle_of_object(page)
    felt = []
    page.mouse("mousePressed", (x, y), button="left", buttons=1, clickCount=1, pointerType="pen", force=0.1)
    for force in (0.1, 0.5):
        page.mouse("mouseMoved", (x + 1, y), button="left", buttons=1, pointerType="pen", force=force)
        felt.append(settled_newtons(page))
    page.mouse("mouseReleased", (x + 1, y), button="left", pointerType="pen")
    checks.that(felt[1] > 1.5 * felt[0] > 0, f"a pen at a tenth and at half of its pressure feels {felt} N")
    checks.that(page.wait_until(kFree), "after it nothing is felt")


# A gamepad that the test holds: the page asks for it in each frame.
kGamepad = ("navigator.getGamepads = () => [{ connected: true, axes: window.axes, buttons: window.buttons }];"
            " window.axes = [0, 0, 0, 0]; window.buttons = Array.from({ length: 8 }, () => ({ value: 0 }));"
            " window.dispatchEvent(new Event('gamepadconnected'))")


def check_gamepad(checks, page):
    page.evaluate(f"document.getElementById('home').click(), {kGamepad}")
    felt = []
    for pull in (0.4, 1):
        page.evaluate(f"window.buttons[7].value = {pull}")
        felt.append(settled_newtons(page))
    checks.that(felt[1] > 1.3 * felt[0] > 0, f"a trigger pulled by 40 % and entirely gives {felt} N")
    page.evaluate("window.axes[0] = 0.8")
    page.wait_until("Number(document.getElementById('tangential').textContent) > 0")
    state = page.evaluate("document.getElementById('state').dataset.state")
    tangential = float(page.evaluate("document.getElementById('tangential').textContent"))
    checks.that(state in ("stick", "slip") and tangential > 0, f"the left stick drags: {state}, {tangential} N across")
    page.evaluate("window.axes[0] = 0, window.buttons[7].value = 0")
    checks.that(page.wait_until(kFree), "the trigger lets go")
    before = canvas_of(page)
    page.evaluate("window.axes[2] = 1")
    for _ in range(kTurnFrames):
        settle(page)
    page.evaluate("window.axes[2] = 0, navigator.getGamepads = () => []")
    changed = sum(sum(abs(a - b) for a, b in zip(*pair)) > 24 for pair in zip(before, canvas_of(page)))
    checks.that(changed > len(before) // 50, f"the right stick turns the view: {changed} pixels change")


def check_phone(checks, page, save):
    page.set_size(*kPhone, phone=True)
    settle(page)
    save("phone", page)
    width, height, canvas_width, canvas_height = page.evaluate(
        "(({width, height}) => [document.documentElement.scrollWidth, document.documentElement.scrollHeight, width, height])"
        "(document.getElementById('view').getBoundingClientRect())")
    cut = page.evaluate("[...document.querySelectorAll('*')].filter((e) => ['auto', 'scroll', 'visible'].includes(getComputedStyle(e).overflowX)"
                        " && e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1).map((e) => e.id || e.tagName)")
    checks.that(width == kPhone[0] and height == kPhone[1] and not cut,
                f"a phone shows the page without scrolling it: {width} x {height}, too wide: {cut}")
    checks.that(canvas_width == kPhone[0] and canvas_height >= 300,
                f"on a phone the object has {canvas_width:.0f} x {canvas_height:.0f} px")
    x, y = middle_of_object(page)
    page.touch("touchStart", [(x, y)])
    checks.that(page.wait_until(kFeels), "a finger is felt")
    for i in range(1, 3):
        page.touch("touchMove", [(x + 16 * i, y + 8 * i)])
    settle(page)
    save("phone-pressed", page)
    page.touch("touchEnd", [])
    checks.that(page.wait_until(kFree), "after the finger is lifted nothing is felt")


def damaged_pages(text):
    """Names and texts of pages whose model was cut off, or is something else."""
    model = re.search(r'(?<=id="model">)[^<]*', text)
    something = base64.b64encode(gzip.compress(b"something else " * 100)).decode()
    for name, damaged in (("cut", model[0][:len(model[0]) // 8 * 4]), ("other", something)):
        yield name, text[:model.start()] + damaged + text[model.end():]


def run(arguments, checks):
    deadline = time.monotonic() + kSeconds
    url = arguments.page.resolve().as_uri()

    save = picture_saver(arguments.pictures)
    with Chromium(arguments.chromium, kSoftwareGl, deadline) as page:
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
        page.set_size(*kDesktop)
        page.open(url)
        page.evaluate("palpate.ready")
        check_forces(checks, page, arguments.folder)
        check_desktop(checks, page, save)
        page.set_size(*kSmall)
        check_pen(checks, page)
        check_gamepad(checks, page)
        check_phone(checks, page, save)
        check_silence(checks, page, url)
        with tempfile.TemporaryDirectory() as folder:
            for name, text in damaged_pages(arguments.page.read_text(encoding="utf-8")):
                damaged = Path(folder) / f"{name}.html"
                damaged.write_text(text, encoding="utf-8")
                check_sentence(checks, page, damaged.as_uri(), "damaged", save)
    with Chromium(arguments.chromium, kNoGl, deadline) as page:
        check_sentence(checks, page, url, "WebGL2", save)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path, help="the page")
    parser.add_argument("folder", type=Path, help="has trace.csv, which `palpate play` recorded with the same model")
    parser.add_argument("--pictures", type=Path, help="folder for screenshots")
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    arguments = parser.parse_args()
    for needed in (arguments.page, arguments.folder / "trace.csv"):
        if not needed.is_file():
            parser.error(f"{needed}: there is no such file")
    checks = Checks()
    try:
        run(arguments, checks)
    except (Failed, OSError) as error:
        checks.that(False, str(error))
    print(f"{checks.failed} checks failed" if checks.failed else "all checks passed")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
