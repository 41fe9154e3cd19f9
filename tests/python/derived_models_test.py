# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Models are scaled, merged, and given to other objects."""
import unittest

import numpy as np

import palpate
from shared import DEMO, sheet_acquisition

POSE = np.array([[0, -1, 0, 5], [1, 0, 0, -3], [0, 0, 1, 40], [0, 0, 0, 1]], float)  # a quarter turn about z
DISPLACEMENTS = np.array([[0, 0, 2], [0.5, 0, 3], [0, -0.5, 1.0]])  # mm, into the sheet and along it


class DerivedModels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        surface = palpate.remesh(palpate.read_mesh(DEMO / "sheet/surface.ply"), edge_length=7).mesh
        cls.model = palpate.fit(sheet_acquisition(), surface).model
        cls.contacts = cls.model.contacts[[3, 17, 30]]
        cls.forces = palpate.BlendedField(cls.model).force(cls.contacts, DISPLACEMENTS)

    def force(self, model, contacts, displacements):
        return palpate.BlendedField(model).force(contacts, displacements)

    def test_of_one_material_twice_the_size_makes_four_times_the_force(self):
        larger, error = palpate.scale_model(self.model, 2)
        self.assertEqual(error, 0)  # no field had to be fitted again
        vertices = self.model.surface.vertices
        centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        scaled = centre + 2 * (self.contacts - centre)
        np.testing.assert_allclose(self.force(larger, scaled, 2 * DISPLACEMENTS), 4 * self.forces, rtol=1e-5, atol=1e-6)
        same, _ = palpate.scale_model(self.model, 2, forces="forces")
        np.testing.assert_allclose(self.force(same, scaled, 2 * DISPLACEMENTS), self.forces, rtol=1e-5, atol=1e-6)
        with self.assertRaisesRegex(palpate.InvalidInput, "factor is 0"):
            palpate.scale_model(self.model, 0)
        with self.assertRaisesRegex(palpate.InvalidInput, "forces: is 'size'"):
            palpate.scale_model(self.model, 2, forces="size")

    def test_more_contacts_are_forecast_to_have_a_smaller_error(self):
        forecast = palpate.ErrorForecast(self.model, largest_depth=2)
        contacts = self.model.contacts
        own = forecast.with_contacts(contacts)
        self.assertAlmostEqual(own, forecast.at_present, delta=0.05 * own)
        more = forecast.with_contacts(np.vstack([contacts, (contacts[:-1] + contacts[1:]) / 2]))
        self.assertLess(more, own)
        self.assertGreater(more, forecast.of_contacts)
        budget = forecast.budget_with(contacts)
        parts = (budget.force_noise, budget.position_noise, budget.fit, budget.across, budget.spacing, budget.contrast)
        self.assertAlmostEqual(np.linalg.norm(parts), own, delta=1e-9)
        self.assertAlmostEqual(budget.stated, own, delta=1e-9)
        self.assertAlmostEqual(budget.with_surface(depth_offset=0.1), np.hypot(own, 0.1 * budget.per_depth_offset), delta=1e-9)
        with self.assertRaisesRegex(palpate.InvalidInput, "depth_offset is -1"):
            budget.with_surface(depth_offset=-1)
        self.assertEqual(budget.per_depth_offset, forecast.budget_at_present.per_depth_offset)
        with self.assertRaisesRegex(palpate.InvalidInput, "reachable has 1 values"):
            palpate.ErrorForecast(self.model, reachable=[True])

    def test_a_model_merged_with_itself_is_the_model_at_the_pose(self):
        merged = palpate.merge_models([self.model, self.model], poses=[POSE, POSE])
        self.assertEqual(merged.components, 1)
        self.assertEqual(merged.source, [(0, contact) for contact in self.model.ids])
        turned = self.contacts @ POSE[:3, :3].T + POSE[:3, 3]
        np.testing.assert_allclose(
            self.force(merged.model, turned, DISPLACEMENTS @ POSE[:3, :3].T),
            self.forces @ POSE[:3, :3].T, rtol=1e-4, atol=1e-4)
        with self.assertRaisesRegex(palpate.InvalidInput, "there must be one for each of the 2 models"):
            palpate.merge_models([self.model, self.model], poses=[POSE])
        with self.assertRaisesRegex(palpate.InvalidInput, "max_distance is -1"):
            palpate.merge_models([self.model], max_distance=-1)

    def test_a_reduced_model_differs_by_no_more_than_allowed(self):
        left = self.model.surface.vertices[:, 0] < 10
        reduced = palpate.reduce_model(self.model, reachable=left, max_error=0.4, strokes=1000)
        self.assertLess(len(reduced.model.contacts), len(self.model.contacts))
        self.assertEqual(len(reduced.model.contacts) + len(reduced.out_of_reach) + len(reduced.predicted),
                         len(self.model.contacts))
        self.assertLessEqual(reduced.difference, reduced.allowed)
        self.assertLess(reduced.size_after, reduced.size_before)
        inside = self.contacts[self.contacts[:, 0] < 0]
        press = np.tile([0, 0, 1.5], (len(inside), 1))
        np.testing.assert_allclose(self.force(reduced.model, inside, press), self.force(self.model, inside, press), atol=0.4)
        with self.assertRaisesRegex(palpate.InvalidInput, "reachable has 2 values"):
            palpate.reduce_model(self.model, reachable=[True, False])
        with self.assertRaisesRegex(palpate.InvalidInput, "max_error is -1"):
            palpate.reduce_model(self.model, max_error=-1)

    def test_the_feel_goes_to_the_same_surface_elsewhere(self):
        surface = self.model.surface
        target = palpate.TriangleMesh(surface.vertices @ POSE[:3, :3].T + POSE[:3, 3], surface.triangles)
        at = surface.vertices[::97]
        shape = palpate.map_surface(surface, target, at, at @ POSE[:3, :3].T + POSE[:3, 3])
        self.assertEqual(shape.verdict, "sensible", shape.reason)
        np.testing.assert_allclose(shape.positions, target.vertices, atol=1e-3)
        self.assertAlmostEqual(shape.scale, 1, 6)
        model = palpate.transfer_model(self.model, target, shape)
        turned = self.contacts @ POSE[:3, :3].T + POSE[:3, 3]
        np.testing.assert_allclose(
            self.force(model, turned, DISPLACEMENTS @ POSE[:3, :3].T), self.forces @ POSE[:3, :3].T, atol=2e-3)
        with self.assertRaises(palpate.InvalidInput):
            palpate.map_surface(surface, target, at[:2], at[:2])
        with self.assertRaisesRegex(palpate.InvalidInput, "max_landmark_distance is 0; it must be > 0"):
            palpate.map_surface(surface, target, at, at, max_landmark_distance=0)


if __name__ == "__main__":
    unittest.main()
