# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Playback gives the bits that `palpate play` recorded, step by step and as a whole."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate
from shared import DEMO, PAGE, grid, recorded


class Playing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.playback = palpate.Playback(palpate.read_model(PAGE / "model"))

    def test_steps_give_the_recorded_bits(self):
        for name in ("trace.csv", "wild_trace.csv"):
            tools, outputs, states = recorded(name)
            self.assertGreater((states != "free").sum(), 500)
            state = palpate.LoopState()
            for tool, output, word in zip(tools, outputs, states):
                command = self.playback.step(tool, state)
                self.assertEqual([*command.contact, *command.force, command.state], [*output, word])
                self.assertEqual(state.state, word)

    def test_a_whole_way_gives_the_recorded_bits(self):
        tools, outputs, states = recorded("wild_trace.csv")
        trace = self.playback.play(tools)
        self.assertEqual(len(trace), len(tools))
        np.testing.assert_array_equal(np.hstack([trace.tool, trace.contact, trace.force]), np.hstack([tools, outputs]))
        np.testing.assert_array_equal(trace.state, states)
        np.testing.assert_allclose(np.diff(trace.time), 1e-3, atol=1e-12)

    def test_files_of_ways_and_traces_are_those_of_the_command(self):
        tools, times = palpate.read_trajectory(DEMO / "trajectory.csv")
        np.testing.assert_array_equal(tools, recorded("trace.csv")[0])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "trace.csv"
            self.playback.play(tools, times).write(path)
            self.assertEqual(path.read_bytes(), (PAGE / "trace.csv").read_bytes())

    def test_a_device_that_follows_its_way_feels_what_the_way_feels(self):
        tools, times = palpate.read_trajectory(DEMO / "trajectory.csv")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "session.bin"
            rigid = palpate.play_device(self.playback, tools, times, device="recorded", coupling=False, ramp=1e-9, slew=1e9,
                                        record=path)
            trace = palpate.read_device_trace(path)
        self.assertEqual(rigid.ticks, len(trace))
        self.assertTrue(np.isinf(rigid.coupling_stiffness))
        played = self.playback.play(trace.tool)
        self.assertEqual(rigid.states, {word: (played.state == word).sum() for word in ("free", "stick", "slip")})
        self.assertAlmostEqual(rigid.largest_force, min(3.3, np.linalg.norm(played.force, axis=1).max()), 6)

    def test_a_hand_gives_way_and_forces_are_limited(self):
        tools, times = palpate.read_trajectory(DEMO / "trajectory.csv")
        weak, strong = (palpate.play_device(self.playback, tools, times, stiffness=k) for k in (0.01, 1))
        self.assertLess(weak.largest_displacement, 0.8 * strong.largest_displacement)
        limited = palpate.play_device(self.playback, tools, times, device="recorded", max_force=0.1)
        self.assertLessEqual(limited.largest_force, 0.1 + 1e-9)
        self.assertGreater(limited.safety["clamped"], 0)
        for options, words in (({"max_force": 0}, "max_force is 0 N; it must be > 0"), ({"mass": -1}, "mass is -1 kg"),
                               ({"device": "recorded", "mass": 1}, "mass: does nothing with device='recorded'; it needs device='hand'"),
                               ({"device": "foot"}, "device: is 'foot'; it must be one of 'hand'")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.play_device(self.playback, tools, times, **options)

    def test_positions_of_any_form_are_taken(self):
        tools, _, states = recorded("trace.csv")
        tool = tools[np.flatnonzero(states == "stick")[100]]
        forces = []
        for given in (tool, tool.tolist(), tuple(tool), np.stack([tool, tool], axis=1)[:, 0], np.array(tool, object).astype(float)):
            forces.append(self.playback.step(given, palpate.LoopState()).force)
        self.assertGreater(np.linalg.norm(forces[0]), 0.05)
        for force in forces:
            np.testing.assert_array_equal(force, forces[0])
        self.assertIs(type(forces[0]), np.ndarray)

    def test_a_position_that_is_not_finite_is_held(self):
        state = palpate.LoopState()
        self.playback.step([0, 0, 600], state)
        command = self.playback.step([np.nan, 0, 600], state)
        self.assertTrue(command.held and np.isfinite(command.force).all())

    def test_the_field_gives_the_force_of_a_contact_that_holds(self):
        model = palpate.read_model(PAGE / "model")
        trace = self.playback.play(recorded("trace.csv")[0])
        holds = trace.state == "stick"
        field = palpate.BlendedField(model)
        forces = field.force(trace.contact[holds], (trace.tool - trace.contact)[holds])
        np.testing.assert_allclose(forces, -trace.force[holds], atol=1e-9)
        deviations = field.deviation(trace.contact[holds], (trace.tool - trace.contact)[holds])
        self.assertTrue((deviations > 0).all())
        self.assertEqual(field.force([[np.nan, 0, 0]], [[0, 0, 1]]).tolist(), [[0, 0, 0]])
        with self.assertRaisesRegex(palpate.InvalidInput, "displacements: has 1 rows; it must have 2"):
            field.force(np.zeros((2, 3)), np.zeros((1, 3)))

    def test_a_drawn_dent_has_the_shape_of_its_formula(self):
        plane = grid(41, 41)
        shape = palpate.drawn_shape(plane, [20, 20, 5], [0, 0.6, -0.8], tip=2, reach=6)
        share = np.minimum(np.linalg.norm(plane.vertices - [20, 20, 0], axis=1) / (2 + 6), 1)
        # Distances along the surface err by some tenths of a percent.
        np.testing.assert_allclose(shape - plane.vertices, np.outer((1 - share**2) ** 2, [0, 0.6, -0.8]), atol=0.01)
        with self.assertRaisesRegex(palpate.InvalidInput, "contact: is not finite"):
            palpate.drawn_shape(plane, [np.nan, 0, 0], [0, 0, 1])

    def test_a_model_without_recorded_surfaces_is_displayed_with_a_drawn_dent(self):
        model, state = palpate.read_model(PAGE / "model"), palpate.LoopState()
        self.assertTrue(np.array_equal(palpate.displayed_shape(model, state), model.surface.vertices))
        tools = recorded("trace.csv")[0]
        for tool in tools:
            command = self.playback.step(tool, state)
            if command.state != "free":
                break
        drawn = palpate.drawn_shape(model.surface, command.contact, tool - command.contact, tip=model.probe_radius or 3)
        np.testing.assert_allclose(palpate.displayed_shape(model, state), drawn, atol=1e-9)

    def test_wrong_arguments_are_refused(self):
        for tool, words in (([1, 2], r"tool: its shape is \(2,\)"), ("abc", "tool: its type"), (None, "tool: "),
                            (np.zeros((1, 3)), r"tool: its shape is \(1, 3\)")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                self.playback.step(tool, palpate.LoopState())
        tools = np.zeros((3, 3))
        for times, words in (([0, 1], "times: must have the shape"), ([0, 2, 1], r"times\[2\] is 1"), ([0, np.nan, 1], r"times\[1\]")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                self.playback.play(tools, times)
        with self.assertRaisesRegex(palpate.InvalidInput, "^start_depth is -1"):
            palpate.Playback(palpate.read_model(PAGE / "model"), start_depth=-1)
        with self.assertRaisesRegex(palpate.InvalidInput, "motion is 'fast'; it must be one of 'bracketed', 'brent'"):
            palpate.Playback(palpate.read_model(PAGE / "model"), motion="fast")

    def test_a_trace_outlives_what_made_it(self):
        forces = palpate.Playback(palpate.read_model(PAGE / "model")).play(recorded("trace.csv")[0]).force
        np.testing.assert_array_equal(forces, recorded("trace.csv")[1][:, 3:])


if __name__ == "__main__":
    unittest.main()
