# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulated objects and arms give what is known of them, and models of them feel like them."""
import math
import os
import pathlib
import signal
import tempfile
import threading
import unittest

import numpy as np

import palpate
from shared import DEMO

# Of an elastic body the compliance is known in closed form (probing/closed_form.h).
BODY = {"type": "elastic_body", "young_modulus": 0.08, "poisson_ratio": 0.4, "tool_radius": 2.5, "size": 40}
NORMAL = (1 - 0.4**2) / (2 * 2.5 * 0.08)  # mm/N
TANGENTIAL = (1 + 0.4) * (2 - 0.4) / (4 * 2.5 * 0.08)


def planned(specimen, **options):
    return palpate.plan_contacts(specimen.surface, spacing=12, **options)


class Specimens(unittest.TestCase):
    def test_an_elastic_body_yields_as_its_formula_says(self):
        body = palpate.Specimen(BODY)
        axis, coefficient = body.friction_cone([0, 0, 700])
        self.assertAlmostEqual(coefficient, 0.7)
        np.testing.assert_allclose(body.displacement([0, 0, 700], 2 * axis), 2 * NORMAL * axis, atol=1e-9)
        np.testing.assert_allclose(body.displacement([0, 0, 700], [0.3, 0, 0]), [0.3 * TANGENTIAL, 0, 0], atol=1e-9)

    def test_descriptions_that_are_wrong_are_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "stiffness"):
            palpate.Specimen({"type": "sheet", "stiffness": 1})
        with self.assertRaisesRegex(palpate.InvalidInput, "shear_modulus is nan; it must be of finite numbers"):
            palpate.Specimen({"type": "finite_elements", "shear_modulus": float("nan")})
        for words, at, force in (("contact is nan mm", [math.nan, 0, 0], [0, 0, 1]), ("force is inf N", [0, 0, 0], [0, 0, math.inf])):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.Specimen({"type": "sheet"}).displacement(at, force)
        with self.assertRaisesRegex(palpate.InvalidInput, "max_force is nan N; it must be > 0"):
            palpate.plan_contacts(palpate.Specimen({"type": "sheet"}).surface, max_force=math.nan)
        with self.assertRaisesRegex(palpate.FileError, "/nowhere.json"):
            palpate.read_specimen("/nowhere.json")
        with self.assertRaisesRegex(palpate.InvalidInput, "force: its shape"):
            palpate.Specimen(BODY).displacement([0, 0, 700], [1, 2])

    def test_known_forces_are_those_of_the_formula(self):
        body, seen = palpate.Specimen(BODY), []
        known = palpate.known_forces(body, queries=20, margin=5, max_force=2, progress=lambda *counts: seen.append(counts))
        self.assertEqual((known.contacts.shape, len(known.unanswered), seen[-1]), ((20, 3), 0, (20, 20)))
        axis, _ = body.friction_cone(known.contacts[0])
        along = known.forces @ axis
        expected = NORMAL * along[:, None] * axis + TANGENTIAL * (known.forces - along[:, None] * axis)
        np.testing.assert_allclose(known.displacements, expected, atol=1e-9)
        self.assertLessEqual(np.linalg.norm(known.forces, axis=1).max(), 2)
        with self.assertRaisesRegex(palpate.InvalidInput, "max_force"):
            palpate.known_forces(body, max_force=0.05)

    def test_a_file_is_read(self):
        specimen = palpate.read_specimen(DEMO / "probing/sheet_block.json")
        self.assertGreater(len(specimen.surface.triangles), 1000)


class Baking(unittest.TestCase):
    def test_a_model_feels_like_its_object(self):
        body = palpate.Specimen(BODY)
        reported = []
        baked = palpate.bake(body, spacing=12, max_force=2, progress=lambda *counts: reported.append(counts))
        self.assertEqual(reported[-1][0], reported[-1][1])
        playback, state = palpate.Playback(baked.model), palpate.LoopState()
        at = baked.model.contacts[0]
        axis, _ = body.friction_cone(at)
        for depth in np.linspace(-1, NORMAL, 40):  # from outside to where the force is 1 N
            command = playback.step(at + depth * axis, state)
        self.assertEqual(command.state, "stick")
        np.testing.assert_allclose(command.force, -axis, atol=0.02)


class Probing(unittest.TestCase):
    def test_a_simulated_arm_measures_the_object(self):
        body = palpate.Specimen(BODY)
        plan = planned(body, contacts=4, directions=2, max_force=1.5)
        self.assertEqual(plan.contacts.shape, (4, 3))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "acquisition.db"
            acquisition = palpate.probe(plan, body, path)
            self.assertEqual(len(palpate.read_acquisition(path).force), len(acquisition.force))
            with self.assertRaisesRegex(palpate.OutputError, "acquisition.db"):
                palpate.probe(plan, body, path)
            other = pathlib.Path(folder) / "other.db"
            with self.assertRaisesRegex(palpate.InvalidInput, "adaptive needs a limit"):
                palpate.probe(plan, body, other, strategy="adaptive")
            few = palpate.probe(plan, body, other, strategy="adaptive", max_samples=30)
            self.assertEqual(len(few.force), 30)
        np.testing.assert_array_equal(acquisition.contacts, plan.contacts)
        # Under the normal force alone the tip is where the formula says, to the noise of the arm.
        normals = acquisition.normals[acquisition.contact]
        pressed = -np.einsum("sd,sd->s", acquisition.force, normals)
        depth = -np.einsum("sd,sd->s", acquisition.a - acquisition.contacts[acquisition.contact], normals)
        self.assertLess(np.sqrt(np.mean((depth - NORMAL * pressed) ** 2)), 0.1)

    def test_a_plan_of_another_surface_is_refused(self):
        other = palpate.Specimen({**BODY, "size": 50})
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(palpate.InvalidInput, "plan: is of another surface"):
                palpate.probe(planned(other), palpate.Specimen(BODY), pathlib.Path(folder) / "a.db")

    def test_ctrl_c_ends_a_campaign_and_keeps_its_trials(self):
        body = palpate.Specimen(BODY)

        def interrupt(done, total):
            if done == 5:
                os.kill(os.getpid(), signal.SIGINT)

        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "acquisition.db"
            with self.assertRaises(KeyboardInterrupt):
                palpate.probe(planned(body), body, path, progress=interrupt)
            self.assertGreaterEqual(len(palpate.read_acquisition(path).force), 5)


class Arms(unittest.TestCase):
    def test_equal_seeds_and_commands_give_equal_states(self):
        def tips(seed):
            arm = palpate.VirtualArm(palpate.Specimen(BODY), seed=seed)
            arm.activate()
            tips = []
            for _ in range(50):
                arm.write([0.2, 0.1, -0.3])
                tips.append(arm.read().tip)
            return np.array(tips)

        np.testing.assert_array_equal(tips(1), tips(1))
        self.assertTrue((tips(1) != tips(2)).any())

    def test_an_arm_falls_by_its_weight(self):
        arm = palpate.VirtualArm()
        first = arm.read()
        for _ in range(300):
            last = arm.read()
        self.assertAlmostEqual(last.time - first.time, 0.3, 9)
        self.assertLess(last.tip[1], first.tip[1] - 1)  # y points up in the frame of the base

    def test_forces_that_are_wrong_are_refused(self):
        arm = palpate.VirtualArm()
        for force in ([0, np.nan, 0], [1, 2], "push"):
            with self.assertRaisesRegex(palpate.InvalidInput, "force: "):
                arm.write(force)


if __name__ == "__main__":
    unittest.main()
