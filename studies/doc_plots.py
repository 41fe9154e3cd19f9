# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""doc_plots.py [FOLDER]: draws the plots of docs/ from the figures beside them, docs/tables/NAME.csv to NAME.svg.

A CSV file begins with a comment that says which program measured it. The SVG files are written to FOLDER, default docs/tables.
The same figures give the same bytes, and tests/house/check_plots.py compares them.
"""
import io
import sys
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_svg import FigureCanvasSVG

from plot_drawing import (COLORS, MARKERS, STYLE, TABLES, add_axes, curves, dots, label_ends, names, new_figure, read, set_lines,
                          set_scale)


def sensing_window():
    rows = [row for row in read("trade-sensing-window") if row["scene"] != "all"]
    figure = new_figure(560)
    shown = {"planes": 0, "folds": 1, "hand": 2, "print": 3, "flag_A/cam": 4}
    grey = {"color": "#aaaaaa", "marker": "", "linewidth": 0.9}

    def of(noise, scene, column):
        return [(row["window_periods"], row[column]) for row in rows if (row["noise_percent"], row["scene"]) == (noise, scene)]

    for left, column, title, kind in ((46, "median_error_percent", "median error [% of the distance]", "log"),
                                      (350, "coverage_percent", "coverage [%]", "linear")):
        axis = add_axes(figure, left, 312, 190, 226, title)
        for scene in names(rows, "scene"):
            if scene not in shown:
                axis.plot(*zip(*of(0.67, scene, column)), **grey)
        curves(axis, {scene: (of(0.67, scene, column), {}) for scene in shown}, ("linear", kind))
        axis.set_xticks([1.25, 2, 3, 4, 6], ["1.25", "2", "3", "4", "6"])
        axis.set_xlabel("window [periods]; grey: other scenes")
    for left, scene in ((46, "planes"), (350, "folds")):
        axis = add_axes(figure, left, 34, 190, 226, f"{scene}: median error [%]")
        axis.set_ylim(0.0005, 0.12)
        curves(axis, {f"noise {noise:g} %": (of(noise, scene, "median_error_percent"), {})
                      for noise in reversed(names(rows, "noise_percent"))}, ("linear", "log"))
        axis.set_xticks([1.25, 2, 3, 4, 6], ["1.25", "2", "3", "4", "6"])
        axis.set_xlabel("window [periods]")
    return figure


def sensing(name, column, key, panels):
    return dots([row for row in read(name) if row["scene"] != "all"], "scene", column, key, panels)


def sensing_faults():
    rows = read("sensing-faults")
    for row in rows:
        row["noticed"] = 100 * row["frames_noticed"] / row["frames"]
    least = {fault: min(row["noticed"] for row in rows if row["fault"] == fault) for fault in names(rows, "fault")}
    rows.sort(key=lambda row: least[row["fault"]])
    return dots(rows, "fault", "frames_of", names(rows, "frames_of"),
                [("frames noticed [%]", "linear", "noticed"), ("confident wrong depths [%]", "linear", "confident_wrong_percent")])


def accuracy(name, panels):
    return dots(read(name), "scene", "rule", ["without", "with"], panels)


def playback_rule():
    rows = read("trade-playback-rule")
    figure = new_figure(330)
    axis = add_axes(figure, 46, 36, 540, 262, "")
    for k, rule in enumerate(names(rows, "rule")):
        for marker, friction in zip("os^", names(rows, "friction")):
            points = [(row["slip_us"], row["error_99_percent_mN"]) for row in rows
                      if (row["rule"], row["friction"]) == (rule, friction)]
            axis.plot(*zip(*points), marker, color=COLORS[k], markersize=6, markerfacecolor="white")
    axis.set_xlim(0.35, 40)
    axis.set_ylim(0.015, 1500)
    for direction in "xy":
        set_scale(axis, direction, "log")
    for x, y, text, k in ((0.42, 5, "bracketed", 0), (13, 0.11, "brent", 1), (2.6, 90, "friction_boundary", 2)):
        axis.text(x, y, text, color=COLORS[k], weight="bold", fontsize=9.5)
    axis.set_xlabel("mean time of a slip [us]")
    axis.set_title("99th percentile of the force error [mN];   friction: ○ 0.5   □ 0.2   △ 0.05", loc="left", fontsize=8.5)
    return figure


def playback_jumps():
    rows = read("trade-playback-jumps")
    frictions = names(rows, "friction")
    figure = new_figure(300)
    axis = add_axes(figure, 46, 36, 410, 238, "largest residual [mN]")

    def largest(chosen):
        return [(k, max(row["largest_residual_mN"] for row in rows if row["friction"] == friction and chosen(row)))
                for k, friction in enumerate(frictions)]

    axis.set_ylim(0, 6000)
    found = {f"hand, jumps of {jump:g} mm": (largest(lambda row, jump=jump: row["object"] == "hand" and row["jump_mm"] == jump), {})
             for jump in (10, 2, 0.3)}
    found["the other objects, all jumps"] = largest(lambda row: row["object"] != "hand"), {"color": "#555555"}
    curves(axis, found, ("linear", 0.1))
    axis.set_xticks(range(len(frictions)), [f"{friction:g}" for friction in frictions])
    axis.set_yticks([0, 0.1, 1, 10, 100, 1000])
    axis.set_xlabel("friction")
    return figure


def playback_energy():
    rows = read("trade-playback-energy")
    for row in rows:
        row["most_returned_N_mm"] = 0.0 if row["most_returned_N_mm"] == "none" else row["most_returned_N_mm"]
    credits = ["infinite", 0.04]
    figure = new_figure(300, ["energy_credit infinite", "0.04 N mm (default)"])
    for left, column, title in ((30, "most_returned_N_mm", "most energy that a loop returns [N mm]"),
                                (330, "slides_beyond_1_mN_percent", "slips of slides more than 1 mN off the cone [%]")):
        axis = add_axes(figure, left, 36, 250, 216, title)
        found = {}
        for k, credit in enumerate(credits):
            for thing, style in (("sheet", "-"), ("waves", "--")):
                points = [(row["friction"], row[column]) for row in rows if (row["object"], row["credit_N_mm"]) == (thing, credit)]
                found[thing, credit] = points, {"color": COLORS[k], "marker": MARKERS[k], "linestyle": style}
                if points[1][1] > 1:
                    axis.annotate(thing, points[1], (8, 3), textcoords="offset points", color=COLORS[k])
        curves(axis, found, ("linear", "linear"), labels=False)
        axis.set_xlabel("friction; dashed: waves")
    return figure


def playback_radius():
    rows = read("trade-playback-radius")
    figure = new_figure(320)
    axis = add_axes(figure, 46, 36, 330, 258, "force / force on the probe's ball of 5 mm")
    found = {}
    for k, thing in enumerate(names(rows, "object")):
        for depth, style in zip(names([row for row in rows if row["object"] == thing], "depth_mm"), ("-", "--")):
            points = [(row["radius_mm"], row["force_over_that_of_5_mm"]) for row in rows
                      if (row["object"], row["depth_mm"]) == (thing, depth)]
            name = f"{thing.removeprefix('finite elements: ')}, {depth:g} mm deep"
            found[name] = sorted([*points, (5.0, 1.0)]), {"color": COLORS[k], "marker": MARKERS[k], "linestyle": style}
    radii = sorted({5.0, *names(rows, "radius_mm")})
    found["square root of the radius (Hertz)"] = [(radius, (radius / 5) ** 0.5) for radius in radii], {"color": "#777777", "marker": ""}
    curves(axis, found, ("log", "log"))
    axis.set_xticks(radii)
    axis.set_xlabel("radius of the ball [mm]")
    return figure


def model_sharing():
    rows = read("trade-model-sharing")
    figure = new_figure(420)
    for k, thing in enumerate(names(rows, "object")):
        axis = add_axes(figure, 46 + 300 * (k % 2), 230 - 194 * (k // 2), 190, 156, f"{thing}: median error [N]")
        axis.set_ylim(0.012, 0.8)
        chosen = [row for row in rows if row["object"] == thing]
        curves(axis, {name: ([(row["samples"], row[f"{column}_median_N"]) for row in chosen], {}) for name, column in
                      (("own", "own"), ("shared", "shared"), ("all samples", "all_samples"))}, ("log", "log"))
        axis.set_xticks([5, 10, 20, 40])
        if k > 1:
            axis.set_xlabel("samples at a contact")
    return figure


def geodesics():
    rows = read("trade-geometry-geodesics")
    figure = new_figure(310)
    axis = add_axes(figure, 46, 36, 540, 248,
                    "mean error [%]; one point for each size of the surface; exact methods at the lower edge")
    axis.set_xlim(0.7, 1500)
    axis.set_ylim(0.05, 15)
    for k, method in enumerate(names(rows, "method")):
        points = [(row["time_over_dijkstra"], row["mean_error_percent"] or 0.05) for row in rows if row["method"] == method]
        axis.plot(*zip(*points), MARKERS[k], color=COLORS[k], markersize=6, clip_on=False)
        axis.annotate(method, max(points), (8, 11), textcoords="offset points", color=COLORS[k], weight="bold",
                      ha="right" if "exact" in method else "left")
    for direction in "xy":
        set_scale(axis, direction, "log")
    axis.set_xlabel("time / time of Dijkstra's algorithm along the edges")
    return figure


def contacts():
    rows = read("trade-geometry-contacts")
    for row in rows:
        row["place"] = f"{row['surface']}, {row['contacts']:g} contacts"

    def both(column):
        return f"voronoi_dual_{column}", f"delaunay_{column}"

    return dots(rows, "place", None, ["voronoi_dual", "delaunay"],
                [("contacts in no triangle [%]", "linear", both("in_no_triangle_percent")), ("holes", "linear", both("holes")),
                 ("projected elsewhere [%]", "linear", ("voronoi_dual_projected_elsewhere_percent",))])


def remeshing():
    rows = read("trade-geometry-remeshing")
    for row in rows:
        row["place"] = f"{row['surface']}, {row['triangles_before']:g} triangles, edges of {row['edge_length_mm']:g} mm"
    return dots(rows, "place", "program", ["Palpate", "CGAL"],
                [("edges in range [%]", "linear", "edges_in_range_percent"), ("thin triangles [%]", "linear", "thin_percent"),
                 ("distance [mm]", "log", "distance_mm"), ("time, CGAL = 1", "linear", "time_over_cgal")])


def decimation():
    rows = [row for row in read("trade-geometry-decimation") if row["verified_bound_mm"]]
    figure = new_figure(300)
    for left, noise in ((46, 0), (330, 0.25)):
        axis = add_axes(figure, left, 36, 176, 240, f"noise {noise} mm: distance from the input [mm]")
        axis.set_ylim(0.02, 6)
        chosen = [row for row in rows if row["noise_mm"] == noise]
        curves(axis, {name: ([(row["triangles_left"], row[column]) for row in chosen][::-1], {}) for name, column in
                      (("meshoptimizer:\nactual", "meshoptimizer_distance_mm"), ("Palpate:\nverified bound", "verified_bound_mm"),
                       ("meshoptimizer:\nestimate", "meshoptimizer_estimate_mm"))}, ("log", "log"), labels=False)
        label_ends(axis, [(chosen[0]["triangles_left"], chosen[0][column], name, COLORS[k]) for k, (name, column) in enumerate(
            (("meshoptimizer,\nactual", "meshoptimizer_distance_mm"), ("Palpate,\nverified", "verified_bound_mm"),
             ("meshoptimizer,\nestimate", "meshoptimizer_estimate_mm")))], gap=20)
        axis.set_xlabel("triangles left")
    return figure


def probing():
    rows = read("trade-probing")
    thesis = {row["object"]: row["rms_error_N"] for row in rows if row["strategy"] == "thesis"}
    kinds = ["sheets", "beams", "elastic body"]
    strategies = names(rows, "strategy")
    figure = new_figure(300, kinds)
    for left, title, kind in ((130, "error / error of thesis", "log"), (380, "hours of the arm", "log")):
        axis = add_axes(figure, left, 26, 206, 228, title)
        for row in rows:
            k = 0 if "sheet" in row["object"] else 1 if "beam" in row["object"] else 2
            x = row["rms_error_N"] / thesis[row["object"]] if left == 130 else row["arm_h"]
            if x is not None:
                axis.plot(x, strategies.index(row["strategy"]) + 0.2 * (k - 1), MARKERS[k], color=COLORS[k], clip_on=False)
        set_scale(axis, "x", kind)
        set_lines(axis, len(strategies), strategies if left == 130 else ())
    return figure


def probing_forces():
    rows = [row for row in read("probing-validation-forces") if not row["compensation"].startswith("with")]
    for row in rows:
        row["place"] = f"{row['object']}, seed {row['seed']:g}"
    return dots(rows, "place", "compensation", ["gravity only", "all compensations"],
                [(f"deviation, {name} [N]", "log", f"deviation_{axis}_N") for axis, name in zip("xyz", ("x", "normal", "z"))])


def plan_forecast():
    rows = read("plan-forecast")
    for row in rows:
        row["place"] = f"{row['object']}, from {row['contacts_of_the_first_model']:g} contacts"
    places = names(rows, "place")
    sizes = [0, 50, 100]  # contacts
    key = ["first model as it is", "41 or 46 contacts", "74 or 95", "133 or 163"]
    figure = new_figure(330, key)
    axis = add_axes(figure, 220, 26, 364, 264, "true error / forecast, lowest to highest of three seeds")
    for row in rows:
        more = row["contacts"] > row["contacts_of_the_first_model"]
        k = sum(row["contacts"] > size for size in sizes) if more else 0
        y = places.index(row["place"]) + 0.2 * (k - 1.5)
        axis.plot([row["true_over_forecast_lowest"], row["true_over_forecast_highest"]], [y, y], "-" + MARKERS[k], color=COLORS[k],
                  markersize=3)
    axis.axvline(1, color="#333333", linewidth=0.8)
    set_scale(axis, "x", "log")
    set_lines(axis, len(places), places)
    return figure


MEDIAN = "median error [%]", "log", "median_error_percent"
RMS = "RMS error [%]", "log", "rms_error_percent"
COVERAGE = "coverage [%]", "linear", "coverage_percent"
WRONG = "wrong [%]", "linear", "wrong_percent"
SIGMA = "error / sigma", "linear", "error_over_sigma"
PLOTS = {
    "trade-sensing-window": sensing_window,
    "trade-sensing-phase": lambda: sensing("trade-sensing-phase", "max_phase_sigma_rad",
                                           ["0.15 rad", "0.25 rad (default)", "0.4 rad"], [RMS, COVERAGE]),
    "trade-sensing-segmentation": lambda: sensing("trade-sensing-segmentation", "segmentation", ["flood", "snakes"],
                                                  [RMS, COVERAGE, WRONG]),
    "trade-sensing-resolution": lambda: sensing("trade-sensing-resolution", "resolution", ["full", "half"],
                                                [MEDIAN, RMS, COVERAGE]),
    "trade-sensing-hard": lambda: sensing("trade-sensing-hard", "segmentation", ["flood", "snakes"], [COVERAGE, WRONG, SIGMA]),
    "sensing-faults": sensing_faults,
    "sensing-accuracy-window": lambda: accuracy("sensing-accuracy-window", [MEDIAN, SIGMA]),
    "sensing-accuracy-edges": lambda: accuracy("sensing-accuracy-edges", [COVERAGE, WRONG, SIGMA, RMS]),
    "sensing-accuracy-texture": lambda: accuracy("sensing-accuracy-texture", [SIGMA]),
    "sensing-accuracy-steps": lambda: accuracy("sensing-accuracy-steps", [
        ("beyond 5 deviations [%]", "linear", "beyond_5_deviations_near_steps_percent"),
        ("error / sigma", "linear", "error_over_sigma_near_steps"), ("confident wrong [%]", "log", "confident_wrong_percent"),
        COVERAGE]),
    "sensing-accuracy-ripples": lambda: accuracy("sensing-accuracy-ripples", [
        ("ripple [%]", "log", "ripple_percent"), ("normals [degrees]", "log", "normals_degrees"), MEDIAN, RMS]),
    "trade-playback-rule": playback_rule,
    "trade-playback-jumps": playback_jumps,
    "trade-playback-energy": playback_energy,
    "trade-playback-radius": playback_radius,
    "trade-model-fields": lambda: dots(read("trade-model-fields"), "fit", "object", ["sheet", "sheet with block"], [
        ("error, truth [N]", "log", "truth_median_N"), ("bytes", "log", "bytes"), ("fit [ms]", "log", "fit_ms"),
        ("force [us]", "log", "force_us")]),
    "trade-model-sharing": model_sharing,
    "trade-model-pressing": lambda: dots(read("trade-model-pressing"), "set", None, ["/ linear", "/ process"], [
        ("error relative to a peer's", "linear", ("model_over_linear", "model_over_process"))], (1, 1)),
    "trade-model-stated": lambda: dots(read("trade-model-stated"), "object", None, ["as stated", "simple law"], [
        ("left out: error / stated", "linear", ("left_out_ratio", "left_out_ratio_simple_law")),
        ("queries: error / stated", "linear", ("queries_ratio", "queries_ratio_simple_law"))], (0.8, 1.2)),
    "trade-geometry-geodesics": geodesics,
    "trade-geometry-contacts": contacts,
    "trade-geometry-remeshing": remeshing,
    "trade-geometry-decimation": decimation,
    "trade-probing": probing,
    "plan-forecast": plan_forecast,
    "probing-validation-forces": probing_forces,
    "non-rigid-tracking": lambda: dots(
        read("non-rigid-tracking"), "sequence", "surface", ["smooth", "with relief", "smooth, with images"], [
            ("median error [mm]", "log", "median_error_mm"), ("error, 95 % [mm]", "log", "error_95_percent_mm"),
            ("error / stated", "log", "error_over_stated_along")]),
}


def draw_all():
    """The texts of the SVG files, by name."""
    texts = {}
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # not what the user's files say
        matplotlib.rcParams.update(STYLE)
        for name, plot in PLOTS.items():
            out = io.StringIO()
            FigureCanvasSVG(plot()).print_svg(out, metadata={"Date": None, "Creator": None})
            # Beside the font that the places are computed for, those that a reader may have.
            texts[name] = out.getvalue().replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")
    return texts


def main(folder):
    for name, text in draw_all().items():
        (folder / f"{name}.svg").write_text(text)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else TABLES)
