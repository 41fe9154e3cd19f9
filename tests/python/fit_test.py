# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Models are fitted, with other threads, progress and Ctrl-C; files that are no models are refused."""
import os
import pathlib
import shutil
import signal
import tempfile
import threading
import time
import unittest

import numpy as np

import palpate
from shared import DEMO, PAGE, grid, recorded, sheet_acquisition


class Fitting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.acquisition = sheet_acquisition()
        cls.surface = palpate.read_mesh(DEMO / "sheet/surface.ply")
        cls.ticks, done = 0, threading.Event()

        def tick():
            while not done.is_set():
                cls.ticks += 1
                time.sleep(1e-3)

        other = threading.Thread(target=tick)
        other.start()
        cls.reported = []
        start = time.process_time()
        cls.fitted = palpate.fit(cls.acquisition, cls.surface, progress=lambda *counts: cls.reported.append(counts))
        cls.whole_time = time.process_time() - start
        done.set()
        other.join()

    def test_another_thread_runs_during_a_fit(self):
        self.assertGreater(self.ticks, 50)  # it takes a second; with the interpreter locked there would be some two

    def test_each_contact_is_reported(self):
        self.assertEqual([count for count, _ in self.reported], list(range(1, 47)))
        self.assertEqual({total for _, total in self.reported}, {46})

    def test_the_command_and_python_fit_the_same_model(self):
        self.assertEqual((self.fitted.left_out, self.fitted.isolated, self.fitted.without_samples), ([], [], []))
        self.assertEqual(self.fitted.registration, "not_needed")
        self.assertGreater(self.fitted.explained, 0.99)
        tools, outputs, states = recorded("trace.csv")
        trace = palpate.Playback(self.fitted.model).play(tools)
        np.testing.assert_array_equal(np.hstack([trace.contact, trace.force]), outputs)
        np.testing.assert_array_equal(trace.state, states)

    def test_ctrl_c_ends_a_fit_that_reports(self):
        reported = []

        def interrupt(count, total):
            reported.append(count)
            if count == 3:
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            palpate.fit(self.acquisition, self.surface, progress=interrupt)
        self.assertLess(reported[-1], 46)

    def test_a_signal_ends_a_fit_that_does_not_report(self):
        # Python would raise it after the fit too: what tells is the processor time that was used.
        before = signal.signal(signal.SIGPROF, signal.default_int_handler)
        start = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, 0.1 * self.whole_time)
        try:
            with self.assertRaises(KeyboardInterrupt):
                palpate.fit(self.acquisition, self.surface)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
            signal.signal(signal.SIGPROF, before)
        self.assertLess(time.process_time() - start, 0.7 * self.whole_time)

    def test_ctrl_c_is_heard_while_a_fit_reports(self):
        heard = threading.Event()

        def hear(*_):
            heard.set()
            raise KeyboardInterrupt

        def interrupt(count, total):
            os.kill(os.getpid(), signal.SIGINT)
            heard.wait(10)

        before = signal.signal(signal.SIGINT, hear)
        try:
            with self.assertRaises(KeyboardInterrupt):
                palpate.fit(self.acquisition, self.surface, progress=interrupt)
        finally:
            signal.signal(signal.SIGINT, before)
        self.assertTrue(heard.is_set())

    def test_what_progress_raises_ends_a_fit(self):
        def stop(count, total):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            palpate.fit(self.acquisition, self.surface, progress=stop)

    def test_wrong_calls_are_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "passive is 'rigid'; it must be one of 'convex', 'certified', 'local'"):
            palpate.fit(self.acquisition, self.surface, passive="rigid")
        with self.assertRaises(palpate.InvalidInput):
            palpate.fit(self.acquisition, grid(5, 5))  # elsewhere
        with self.assertRaises(palpate.InvalidInput):
            palpate.fit(self.acquisition, self.surface, max_distance=np.nan)


class Models(unittest.TestCase):
    def test_a_model_is_written_and_read(self):
        model = palpate.read_model(PAGE / "model")
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder) / "copy"
            model.write(copy)
            read = palpate.read_model(copy)
            (copy / "mine.txt").write_text("kept")
            with self.assertRaisesRegex(palpate.InvalidInput, "mine.txt"):
                model.write(copy)
        for name in ("contacts", "ids", "friction", "rms", "samples", "triangles"):
            np.testing.assert_array_equal(getattr(read, name), getattr(model, name), name)
        np.testing.assert_array_equal(read.surface.vertices, model.surface.vertices)
        self.assertEqual((read.made, read.unknown_friction), (model.made, 0))
        self.assertEqual((read.triangulation, read.samples_fingerprint), ("delaunay", model.samples_fingerprint))
        self.assertRegex(model.samples_fingerprint, "^[0-9a-f]{16}$")
        self.assertEqual(model.contacts.shape, (46, 3))
        np.testing.assert_array_equal(model.ids, sheet_acquisition().contact_ids)

    def test_the_surface_of_a_model_is_a_copy(self):
        model = palpate.read_model(PAGE / "model")
        model.surface.vertices[:] = np.nan
        self.assertTrue(np.isfinite(model.surface.vertices).all())

    def test_what_is_no_model_is_refused(self):
        with self.assertRaisesRegex(palpate.FileError, "there is no such folder"):
            palpate.read_model("/nowhere")
        with self.assertRaisesRegex(palpate.FileError, "expected a model folder|surface.ply"):
            palpate.read_model(DEMO)
        with tempfile.TemporaryDirectory() as folder:
            for what, right, wrong in (("version", '"version":1', '"version":2'), ("field.json", '"contacts"', '"kontacts"')):
                broken = pathlib.Path(folder) / what
                shutil.copytree(PAGE / "model", broken)
                field = broken / "field.json"
                self.assertIn(right, field.read_text())
                field.write_text(field.read_text().replace(right, wrong))
                with self.assertRaisesRegex(palpate.FileError, what):
                    palpate.read_model(broken)
            field.write_text(field.read_text()[:1000])
            with self.assertRaisesRegex(palpate.FileError, "field.json"):
                palpate.read_model(broken)


class Acquisitions(unittest.TestCase):
    def test_what_cannot_be_measured_is_refused_and_what_is_suspicious_warned_of(self):
        right = sheet_acquisition()

        def changed(**change):
            arrays = {name: getattr(right, name) for name in ("contacts", "normals", "contact", "force", "a", "b")}
            options = {name: getattr(right, name) for name in ("contact_ids", "slipped")}
            return palpate.Acquisition(**{**arrays, **options, **change})

        surface = palpate.read_mesh(DEMO / "sheet/surface.ply")
        with self.assertRaisesRegex(palpate.InvalidInput, "those of the object on the tool"):
            palpate.fit(changed(force=-right.force), surface)
        some = right.normals.copy()
        some[:3] *= -1
        with self.assertWarnsRegex(UserWarning, "3 of 46 contacts"), self.assertRaises(palpate.InvalidInput):
            palpate.fit(changed(normals=some), surface)    # three are too many to be left out
        with tempfile.TemporaryDirectory() as folder:
            mapping = pathlib.Path(folder) / "wrong.yaml"
            mapping.write_text("forces_on: tool\n")
            with self.assertRaisesRegex(palpate.InvalidInput, "those of the object on the tool"):
                palpate.import_acquisition([DEMO / "sheet/contacts.csv", DEMO / "sheet/samples.csv"], mapping)
            mapping.write_text("forces_on: tool\ndecimal: comma\n")
            read = palpate.import_acquisition([DEMO / "sheet/contacts.csv", DEMO / "sheet/samples.csv"], mapping,
                                              forces_on="object", decimal="point")
            np.testing.assert_array_equal(read.force, right.force)

    def test_a_surface_is_made_of_the_contacts(self):
        acquisition = sheet_acquisition()
        surface = palpate.contact_surface(acquisition)
        np.testing.assert_array_equal(surface.vertices, acquisition.contacts)
        finer = palpate.contact_surface(acquisition, longest_edge=1.2)
        self.assertLess(len(finer.triangles), len(surface.triangles))
        with self.assertRaisesRegex(palpate.InvalidInput, "longest_edge is 1; it must be > 1 and finite"):
            palpate.contact_surface(acquisition, longest_edge=1)

    def test_samples_are_those_of_the_files(self):
        acquisition = sheet_acquisition()
        rows = np.genfromtxt(DEMO / "sheet/samples.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        np.testing.assert_array_equal(acquisition.contact, rows["contact"])
        np.testing.assert_array_equal(acquisition.force, np.stack([rows["px"], rows["py"], rows["pz"]], axis=1))
        np.testing.assert_array_equal(acquisition.b, np.stack([rows["bx"], rows["by"], rows["bz"]], axis=1))
        np.testing.assert_array_equal(acquisition.slipped, rows["slipped"] == 1)
        np.testing.assert_allclose(np.linalg.norm(acquisition.normals, axis=1), 1, atol=2e-3)

    def test_a_database_is_read_back(self):
        acquisition = sheet_acquisition()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "acquisition.db"
            palpate.write_acquisition(path, acquisition)
            read = palpate.read_acquisition(path)
        for name in ("contact_ids", "contacts", "normals", "contact", "force", "a", "b", "slipped", "time"):
            np.testing.assert_array_equal(getattr(read, name), getattr(acquisition, name), name)

    def test_arrays_make_an_acquisition(self):
        read = sheet_acquisition()
        rows = np.genfromtxt(DEMO / "sheet/samples.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        shuffled = np.random.default_rng(1).permutation(len(rows))
        made = palpate.Acquisition(
            read.contacts, read.normals, read.contact[shuffled], read.force[shuffled], read.a[shuffled], read.b[shuffled],
            contact_ids=read.contact_ids, group=rows["group_id"][shuffled], slipped=read.slipped[shuffled], probe_radius=2.5)
        self.assertEqual((made.probe_radius, made.slipped.sum()), (2.5, read.slipped.sum()))
        for contact in read.contact_ids:
            for name in ("force", "a", "b"):
                ours, theirs = (getattr(x, name)[x.contact == contact] for x in (made, read))
                np.testing.assert_array_equal(np.sort(ours, axis=0), np.sort(theirs, axis=0))

    def test_arrays_that_do_not_fit_are_refused(self):
        contacts, normals = np.eye(3), np.tile([0, 0, -1.0], (3, 1))
        force = np.tile([0, 0, 1.0], (2, 1))

        def refuses(words, **changed):
            given = {"contacts": contacts, "normals": normals, "contact": [0, 2], "force": force, "a": force, "b": force} | changed
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.Acquisition(**given)

        refuses("normals: has 2 rows; it must have 3, one for each of the contacts", normals=normals[:2])
        refuses("a: has 1 rows; it must have 2, one for each of the samples", a=force[:1])
        refuses("slipped: has 3 rows", slipped=[True, False, True])
        refuses("contact", contact=[0, 3])
        refuses("normal", normals=2 * normals)
        refuses("time", time=[0, -1])
        refuses("force", force=[[0, 0, 1], [0, np.nan, 1]])
        refuses("radius", probe_radius=0)

    def test_files_that_are_missing_or_wrong_are_named(self):
        with self.assertRaisesRegex(palpate.FileError, "/nowhere.db"):
            palpate.read_acquisition("/nowhere.db")
        with self.assertRaisesRegex(palpate.FileError, "samples.csv"):
            palpate.read_acquisition(DEMO / "sheet/samples.csv")
        with self.assertRaises(palpate.InvalidInput):
            palpate.import_acquisition([])


if __name__ == "__main__":
    unittest.main()
