# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Models are compared with known forces, with left-out contacts and with parametric models."""
import unittest

import numpy as np

import palpate
from shared import DEMO, sheet_acquisition


class Evaluation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.acquisition = sheet_acquisition()
        cls.model = palpate.fit(cls.acquisition, palpate.read_mesh(DEMO / "sheet/surface.ply")).model
        rows = np.loadtxt(DEMO / "sheet/queries.csv", delimiter=",", skiprows=1)
        cls.contacts, cls.displacements, cls.forces = rows[:, :3], rows[:, 3:6], rows[:, 6:]

    def test_errors_are_those_of_the_field(self):
        errors = palpate.evaluate(self.model, self.contacts, self.displacements, self.forces)
        off = palpate.BlendedField(self.model).force(self.contacts, self.displacements) - self.forces
        lengths = np.linalg.norm(off, axis=1)
        self.assertEqual(errors.count, len(lengths))
        self.assertAlmostEqual(errors.rms, np.sqrt((lengths**2).mean()), 12)
        self.assertAlmostEqual(errors.median, np.median(lengths), 12)
        self.assertAlmostEqual(errors.explained, 1 - (lengths**2).sum() / (self.forces**2).sum(), 12)

    def test_other_signs_and_units_show_in_the_scale(self):
        opposite = palpate.evaluate(self.model, self.contacts, self.displacements, -self.forces)
        self.assertAlmostEqual(opposite.scale, -1, 1)
        grams = palpate.evaluate(self.model, self.contacts, self.displacements, self.forces / 9.80665e-3)
        self.assertAlmostEqual(grams.scale, 102, delta=2)

    def test_wrong_queries_are_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "same number"):
            palpate.evaluate(self.model, self.contacts, self.displacements[1:], self.forces)
        with self.assertRaisesRegex(palpate.InvalidInput, "mm from the surface"):
            palpate.evaluate(self.model, self.contacts + [0, 0, 30], self.displacements, self.forces)
        with self.assertRaisesRegex(palpate.InvalidInput, "max_distance is -1"):
            palpate.evaluate(self.model, self.contacts, self.displacements, self.forces, max_distance=-1)

    def test_a_contact_that_is_left_out_is_predicted_worse_than_its_own_fit(self):
        reported = []
        errors = palpate.leave_one_out(
            self.model, self.acquisition, suggestions=2, progress=lambda *counts: reported.append(counts))
        self.assertEqual(reported[-1], (46, 46))
        np.testing.assert_array_equal(errors.ids, self.model.ids)
        self.assertGreater(np.median(errors.contact_rms / self.model.rms), 1)
        self.assertLess(errors.interior_rms, errors.border_rms)
        self.assertLessEqual(len(errors.suggested), 2)

    def test_a_sheet_is_identified_with_the_noise_of_its_measurements(self):
        found = palpate.identify(self.acquisition)
        self.assertEqual(found.verdict, "describes")
        self.assertAlmostEqual(found.displacement_noise, 0.02, delta=0.4 * 0.02)  # mm, as demo/README.md says, known to 40 %
        tension = next(parameter for parameter in found.parameters if parameter.name == "tension")
        self.assertEqual((tension.status, tension.unit), ("determined", "N"))
        self.assertGreater(tension.value, 5 * tension.standard_error)
        known = palpate.identify(self.acquisition, displacement_noise=0.02, force_noise=0.01)
        again = next(parameter for parameter in known.parameters if parameter.name == "tension")
        self.assertLess(abs(again.value - tension.value), 3 * tension.standard_error)

    def test_a_solid_is_identified_from_presses_that_the_solid_itself_answers(self):
        block = {"type": "finite_elements", "size": [30, 30, 12], "cells": [4, 4, 2], "shear_modulus": 0.05}
        truth = palpate.Specimen({**block, "shear_modulus": 0.08, "bulk_modulus": 1.6})
        at = np.array([1.0, 2.0, 700.0])
        forces = np.array([[0, 0, 0.5], [0, 0, 1.0], [0.2, 0, 1.0]])
        moved = at + np.array([truth.displacement(at, force) for force in forces])
        acquisition = palpate.Acquisition(
            [at], [[0, 0, -1]], [0, 0], forces[[0, 2]], moved[[0, 1]], moved[[0, 2]], group=[0, 1])
        found = palpate.identify_solid(
            acquisition, palpate.Specimen(block), mesh_pairs=0, displacement_noise=0.01, force_noise=0)
        shear = found.report.parameters[0]
        self.assertEqual((shear.name, shear.unit, shear.status), ("shear modulus", "N/mm^2", "determined"))
        self.assertAlmostEqual(shear.value, 0.08, delta=0.004)
        self.assertTrue(np.isnan(found.mesh_errors).all())
        again = found.specimen.displacement(at, forces[1]) - (moved[1] - at)
        self.assertLess(np.linalg.norm(again), 0.05)
        with self.assertRaisesRegex(palpate.InvalidInput, "max_pairs"):
            palpate.identify_solid(acquisition, palpate.Specimen(block), max_pairs=0)

    def test_a_stiff_part_is_found_where_it_is(self):
        # A plane with springs: twice as stiff at (40, 40), half of that 12 mm away.
        x, y = np.meshgrid(np.arange(0, 81, 8.0), np.arange(0, 81, 8.0))
        places = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
        stiffness = 0.1 * (1 + np.exp2(-((places[:, :2] - 40) ** 2).sum(axis=1) / 144))
        up, inwards = np.tile([0.0, 0, 1], (len(places), 1)), [0.0, 0, -1]
        force = np.tile([0.0, 0, -1], (len(places), 1))
        pressed = places + np.outer(1 / stiffness, inwards)
        acquisition = palpate.Acquisition(places, up, np.arange(len(places)), force, pressed, pressed)
        n = 41
        grid = np.arange(n * n).reshape(n, n)
        vertices = np.stack([*(2.0 * np.indices((n, n)).reshape(2, -1)), np.zeros(n * n)], axis=1)
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
        found = palpate.stiffness_map(acquisition, palpate.TriangleMesh(vertices, triangles),
                                      position_noise=1e-3, force_noise=1e-4)
        self.assertTrue(found.distinct)
        self.assertEqual(found.stiffness.shape, (n * n,))
        self.assertAlmostEqual(found.stiff, 0.2, delta=0.004)
        radius = 12 * np.sqrt(-np.log2(found.threshold / 0.1 - 1))
        self.assertEqual(found.contour.shape[1:], (2, 3))
        np.testing.assert_allclose(np.linalg.norm(found.contour - [40, 40, 0], axis=2), radius, atol=0.6)
        with self.assertRaisesRegex(palpate.InvalidInput, "position"):
            palpate.stiffness_map(acquisition, palpate.TriangleMesh(vertices, triangles), position_noise=-1)

    def test_a_sheet_is_no_half_space(self):
        self.assertEqual(palpate.identify(self.acquisition, "half-space", tool_radius=3).verdict, "does_not_describe")
        with self.assertRaisesRegex(palpate.InvalidInput, "tool_radius"):
            palpate.identify(self.acquisition, "half-space")
        with self.assertRaisesRegex(palpate.InvalidInput, "force_noise is given alone; give both displacement_noise"):
            palpate.identify(self.acquisition, force_noise=0.01)


if __name__ == "__main__":
    unittest.main()
