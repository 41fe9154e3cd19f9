#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Lets PALPATE make pages of range maps and meshes whose values are known, and checks them in a headless Chromium.

Values that the page tells, under the pointer too, must be those of the files within the bounds that it states; image and surface
must be drawn, unknown pixels apart; playing, keys and slider must change the frame; nothing may be asked of the network; a damaged
frame and a browser without WebGL2 must be spoken of. Ends with status 0 if all is well, with 1 and words if not.
"""
import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import data_files
from chromium import Chromium, Failed
from page_checks import (Checks, canvas_box, canvas_of, check_sentence, check_silence, kDesktop, kNoGl, kPhone, kSoftwareGl,
                         picture_saver, settle)
from png import rows_of

kSeconds = 240  # for everything, on a machine that is busy with other work
kRounding = 1e-9  # [mm] of numbers near 1000
kSigmaBound = 0.0101  # of the deviation: exp(0.01) - 1
kRayBound = 2e-5  # of the depth: rays between grid points are interpolated


def text_of(page, name):
    return page.evaluate(f"document.getElementById({json.dumps(name)}).textContent")


def number_of(text):
    """The number in a value that is shown; NaN if none is known."""
    found = re.search(r"-?[0-9.]+", text)
    return float(found[0]) if found else math.nan


def same(found, expected, bound):
    """Whether a number (null in JSON if it is NaN) is the expected one within the bound; NaN is NaN."""
    if found is None or math.isnan(found):
        return math.isnan(expected)
    return abs(found - expected) <= bound


def spread(pixel):
    return max(pixel) - min(pixel)


def shade_at(page, column, row):
    """The colour with which a pixel of the image is drawn."""
    x, y = page.evaluate(f"(({{x, y}}) => [x, y])(palpate.placeOf({column}, {row}))")
    return rows_of(page.screenshot((int(x), int(y), 1, 1)))[0][0]


def check_values(checks, page, frames):
    """All values of all frames."""
    step = page.evaluate("facts_of = JSON.parse(document.getElementById('facts-data').textContent), facts_of.step")
    smallest = min(sigma for _, sigmas, _ in frames for sigma in sigmas if sigma == sigma)
    checks.that(0 < step <= smallest / 10, f"the step of {step} mm is at most a tenth of the smallest deviation, {smallest:.4f} mm")
    wrong = 0
    for number, (depths, sigmas, reasons) in enumerate(frames):
        page.evaluate(f"palpate.show({number})")
        shown = page.evaluate(
            f"Array.from({{ length: {len(depths)} }}, (_, i) => (({{ depth, sigma, reason }}) => [depth, sigma, reason])"
            f"(palpate.valuesAt(i % {data_files.kWidth}, Math.floor(i / {data_files.kWidth}))))")
        for (depth, sigma, reason), true_depth, true_sigma, true_reason in zip(shown, depths, sigmas, reasons):
            wrong += not (same(depth, true_depth, step / 2 + kRounding) and same(sigma, true_sigma, kSigmaBound * true_sigma)
                          and reason == true_reason)
    checks.that(wrong == 0, f"{wrong} of {len(frames) * len(depths)} pixels are not what was decoded, within {step / 2:g} mm and 1 %")
    return step


def check_pointer(checks, page, frames, step):
    """What is told of a pixel that is pointed at."""
    page.evaluate("palpate.show(1)")
    depths, sigmas, reasons = frames[1]
    right = 0
    places = [(30, 60), (80, 50), (120, 90), (2, 60), (155, 116)]
    for column, row in places:
        x, y = page.evaluate(f"(({{x, y}}) => [x, y])(palpate.placeOf({column}, {row}))")
        page.mouse("mouseMoved", (x, y))
        page.wait_until(f"document.getElementById('value-pixel').textContent === 'column {column}, row {row}'")
        i = row * data_files.kWidth + column
        right += (same(number_of(text_of(page, "value-depth")), depths[i], step / 2 + kRounding)
                  and same(number_of(text_of(page, "value-sigma")), sigmas[i], 0.02 * sigmas[i])
                  and (text_of(page, "value-reason") == "reconstructed") == (reasons[i] == 0))
    checks.that(right == len(places), f"{right} of {len(places)} pixels that are pointed at are told right")


def check_image(checks, page, save):
    page.set_size(*kDesktop)
    settle(page)
    save("range", page)
    near, far, unknown = shade_at(page, 80, 50), shade_at(page, 15, 116), shade_at(page, 120, 90)
    checks.that(near[0] < 90 and near[1] < 60 and far[0] > 150 and far[2] < 120, f"what is near is violet {near}, what is far yellow {far}")
    checks.that(spread(unknown) < 30 and spread(near) > 60 and spread(far) > 60, f"an unknown pixel is grey {unknown}")
    page.evaluate("for (const [id, value] of [['low', 600], ['high', 700]]) {"
                  " document.getElementById(id).value = value; document.getElementById(id).dispatchEvent(new Event('change')); }")
    settle(page)
    changed = shade_at(page, 80, 50)
    checks.that(changed != near, f"another scale gives another colour, {changed}")
    page.evaluate("document.getElementById('whole').click()")
    page.evaluate("document.querySelector('[value=sigma]').click()")
    settle(page)
    small, large = shade_at(page, 15, 60), shade_at(page, 157, 60)
    checks.that(small[0] < 90 and small[1] < 60 and large[0] > 150 and large[2] < 120, f"small deviations are violet {small}, large ones yellow {large}")
    page.evaluate("document.querySelector('[value=reason]').click()")
    settle(page)
    save("range-reasons", page)
    listed = page.evaluate("[...document.querySelectorAll('#labels li:not(.none)')].map((line) => line.innerText).join(' ')")
    checks.that(shade_at(page, 2, 60) == (0, 0, 0) and "uneven phase" in listed and "unlit" in listed, f"reasons have colours and shares: {listed!r}")
    page.evaluate("document.querySelector('[value=depth]').click()")


def check_scale(checks, page, frames):
    """A scale that nobody has set: of each frame where the walls are far apart, of all frames where they are alike."""
    ends = "['low', 'high'].map((id) => Number(document.getElementById(id).value))"
    off = 0
    for number, (depths, _, _) in enumerate(frames):
        page.evaluate(f"palpate.show({number})")
        known = sorted(depth for depth in depths if depth == depth)
        aside = len(known) // 100
        off = max(off, *(abs(a - b) for a, b in zip(page.evaluate(ends), (known[aside], known[-1 - aside]))))
    checks.that(off < 0.01, f"the scale of depths is that of the frame, within {off:.4f} mm")
    page.evaluate("document.querySelector('[value=sigma]').click()")
    low, high = page.evaluate(ends)
    for number in range(len(frames)):
        page.evaluate(f"palpate.show({number})")
        checks.that(page.evaluate(ends) == [low, high], f"the scale of deviations is the same in frame {number}")
    page.evaluate("document.querySelector('[value=depth]').click()")


def check_playing(checks, page):
    page.evaluate("palpate.show(0)")
    page.evaluate("document.getElementById('speed').value = '25', document.getElementById('play').click()")
    checks.that(page.wait_until("palpate.shown() === 2") and page.wait_until("palpate.shown() === 0"), "playing shows all frames, and begins again")
    page.evaluate("document.getElementById('play').click()")
    page.evaluate("palpate.show(1)")
    page.mouse("mousePressed", (300, 300), button="left", buttons=1, clickCount=1)
    page.mouse("mouseReleased", (300, 300), button="left")
    page.key("keyDown", "ArrowRight", "ArrowRight", 39)
    checks.that(page.wait_until("palpate.shown() === 2"), "an arrow key shows the next frame")
    page.evaluate("document.getElementById('frame').value = '0', document.getElementById('frame').dispatchEvent(new Event('input'))")
    checks.that(page.wait_until("palpate.shown() === 0"), "the slider shows its frame")


def check_surface(checks, page, frames, save):
    """The surface of a range map in space."""
    off = 0.0
    for column, row in ((10, 5), (80, 60), (37, 111), (159, 119)):
        point = page.evaluate(f"palpate.pointAt({column}, {row})")
        x, y = data_files.ray(column, row)
        off = max(off, math.hypot(point[0] - x * point[2], point[1] - y * point[2]) / point[2])
    checks.that(off < kRayBound, f"points in space are within {off:.2g} of their depth of where the lens shows them")
    page.evaluate("document.getElementById('in-space').click()")
    settle(page)
    time.sleep(0.1)
    before = canvas_of(page)
    save("range-surface", page)
    colored = sum(spread(pixel) > 60 for pixel in before)
    checks.that(colored > len(before) // 20, f"the surface has {colored} coloured pixels of {len(before)}")
    x, y, width, height = canvas_box(page)
    middle = x + width / 2, y + height / 2
    page.mouse("mouseMoved", middle)
    settle(page)
    column, row = map(int, re.findall(r"\d+", text_of(page, "value-pixel")))
    told = number_of(text_of(page, "value-depth"))
    checks.that(same(told, frames[0][0][row * data_files.kWidth + column], 0.01), f"the surface tells the depth of pixel {column}, {row}: {told} mm")
    page.mouse("mousePressed", middle, button="left", buttons=1, clickCount=1)
    page.mouse("mouseMoved", (middle[0] + 80, middle[1]), button="left", buttons=1)
    page.mouse("mouseReleased", (middle[0] + 80, middle[1]), button="left")
    settle(page)
    changed = sum(sum(abs(a - b) for a, b in zip(*pair)) > 24 for pair in zip(before, canvas_of(page)))
    checks.that(changed > len(before) // 50, f"a drag turns it: {changed} pixels change")
    page.evaluate("document.querySelector('[name=where]').click()")


def check_phone(checks, page, save):
    page.set_size(*kPhone, phone=True)
    settle(page)
    x, y = page.evaluate("(({x, y}) => [x, y])(palpate.placeOf(80, 60))")
    page.touch("touchStart", [(x, y)])
    page.touch("touchEnd", [])
    settle(page)
    save("range-phone", page)
    told = text_of(page, "value-pixel")
    checks.that(re.match(r"column (79|80|81), row (59|60|61)", told), f"a finger reads a pixel: {told}")
    wide = page.evaluate("document.documentElement.scrollWidth")
    height = canvas_box(page, "image")[3]
    checks.that(wide <= kPhone[0] and height > 200, f"on a phone the page is {wide} px wide, and the image {height:.0f} px high")
    page.set_size(*kDesktop)


def check_meshes(checks, page, meshes, save):
    page.set_size(*kDesktop)
    step, numbers_step = page.evaluate("(({ step, quantities }) => [step, quantities[0].step])(JSON.parse(document.getElementById('facts-data').textContent))")
    wrong = 0
    for number, (vertices, numbers) in enumerate(meshes):
        page.evaluate(f"palpate.show({number})")
        shown = page.evaluate(f"Array.from({{ length: {len(vertices)} }}, (_, i) => (({{ place, distance }}) => [place, distance])(palpate.valuesAt(i)))")
        for (place, distance), vertex, value in zip(shown, vertices, numbers):
            wrong += not (all(same(a, b, step / 2 + kRounding) for a, b in zip(place, vertex)) and same(distance, value, numbers_step / 2 + kRounding))
    checks.that(wrong == 0, f"{wrong} of {len(meshes) * len(vertices)} vertices are not those of the files, within {step / 2:g} mm")
    plain = canvas_of(page)
    page.evaluate("document.querySelector('[name=shown][value=\"0\"]').click()")
    settle(page)
    save("mesh", page)
    colored = canvas_of(page)
    checks.that(sum(spread(pixel) > 60 for pixel in colored) > len(colored) // 20 > sum(spread(pixel) > 60 for pixel in plain),
                "numbers of vertices have colours, the plain surface has none")
    page.evaluate("document.getElementById('edges').click()")
    settle(page)
    changed = sum(sum(abs(a - b) for a, b in zip(*pair)) > 24 for pair in zip(colored, canvas_of(page)))
    checks.that(changed > len(colored) // 100, f"edges change {changed} pixels")
    vertices, numbers = meshes[-1]
    right, chosen = 0, (300, 301, 324, 331, 410)
    for i in chosen:
        x, y = page.evaluate(f"(({{x, y}}) => [x, y])(palpate.placeOf({i}))")
        page.mouse("mouseMoved", (x + 0.3, y + 0.3))
        settle(page)
        right += number_of(text_of(page, "value-vertex")) == i and same(number_of(text_of(page, "value")), numbers[i], numbers_step / 2 + kRounding)
    checks.that(right == len(chosen), f"{right} of {len(chosen)} vertices that are pointed at are told right")
    page.evaluate("palpate.show(0)")
    page.evaluate("document.getElementById('speed').value = '25', document.getElementById('play').click()")
    checks.that(page.wait_until("palpate.shown() === 1"), "the meshes play")


def damaged(text):
    """The page, with bytes of its second frame changed."""
    blocks = list(re.finditer(r'(?<=class="block">)[^<]*', text))
    data = blocks[2][0]
    return text[:blocks[2].start()] + data[:len(data) // 8 * 4] + text[blocks[2].end():]


def check_damaged(checks, page, url):
    page.open(url)
    page.evaluate("palpate.ready")
    page.evaluate("palpate.show(1)")
    said = text_of(page, "message")
    checks.that("000001.tiff in this page are damaged" in said and page.evaluate("!document.getElementById('message').hidden"), f"it is said: {said!r}")
    page.evaluate("palpate.show(2)")
    checks.that(page.evaluate("document.getElementById('message').hidden && palpate.shown() === 2"), "the other frames are shown")


def run(arguments, checks, folder):
    frames = data_files.write_range_maps(folder / "range")
    meshes = data_files.write_meshes(folder / "meshes")
    for name in ("range", "meshes"):
        subprocess.run([arguments.palpate, "export", folder / name, "--html", "-o", folder / f"{name}.html"], check=True, stdout=subprocess.DEVNULL)
    text = (folder / "range.html").read_text(encoding="utf-8")
    (folder / "damaged.html").write_text(damaged(text), encoding="utf-8")
    blocks = sum(len(block) for block in re.findall(r'class="block">([^<]*)', text))
    checks.that(len(text) - blocks <= 300_000, f"the page has {len(text)} bytes, {blocks} of them data")
    save = picture_saver(arguments.pictures)
    deadline = time.monotonic() + kSeconds
    url = (folder / "range.html").as_uri()
    with Chromium(arguments.chromium, kSoftwareGl, deadline) as page:
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
        page.set_size(*kDesktop)
        page.open(url)
        page.evaluate("palpate.ready")
        step = check_values(checks, page, frames)
        check_scale(checks, page, frames)
        check_pointer(checks, page, frames, step)
        check_image(checks, page, save)
        check_playing(checks, page)
        check_surface(checks, page, frames, save)
        check_phone(checks, page, save)
        check_silence(checks, page, url)
        check_damaged(checks, page, (folder / "damaged.html").as_uri())
        page.events.clear()
        url = (folder / "meshes.html").as_uri()
        page.open(url)
        page.evaluate("palpate.ready")
        check_meshes(checks, page, meshes, save)
        check_silence(checks, page, url)
    with Chromium(arguments.chromium, kNoGl, deadline) as page:
        check_sentence(checks, page, url, "WebGL2", save)
        page.open((folder / "range.html").as_uri())
        page.evaluate("palpate.ready")
        settle(page)
        checks.that(spread(shade_at(page, 15, 116)) > 60, "without WebGL2 the image is shown")
        page.evaluate("document.getElementById('in-space').click()")
        checks.that("WebGL2" in text_of(page, "message"), f"and it is said: {text_of(page, 'message')!r}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("palpate", help="the command")
    parser.add_argument("--pictures", type=Path, help="folder for screenshots")
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    arguments = parser.parse_args()
    checks = Checks()
    try:
        with tempfile.TemporaryDirectory() as folder:
            run(arguments, checks, Path(folder))
    except (Failed, OSError, subprocess.CalledProcessError) as error:
        checks.that(False, str(error))
    print(f"{checks.failed} checks failed" if checks.failed else "all checks passed")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
