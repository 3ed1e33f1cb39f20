"""What perf/contact does without Blender: parts, files, statistics, table. `contact_test.py PRCAGE_PROGRAM`"""
import pathlib
import shutil
import sys
import tempfile
import unittest

import parts
import proxies
import results

PROGRAM = pathlib.Path(sys.argv.pop()).resolve() if len(sys.argv) > 1 else None


def rows(energy, seconds=0.01, inside=0, depth=0.0):
    return [{"frame": frame, "seconds": seconds, "inside": inside, "depth": depth, "energy": energy(frame)}
            for frame in range(2, 121)]


def volume(points, triangles):
    a_b_c = [[points[i] for i in t] for t in triangles]
    return sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3])
               for a, b, c in a_b_c for i in range(3)) / 6


class Parts(unittest.TestCase):
    def test_log_has_the_volume_of_its_cells(self):
        cells = sum(row.count("#") for row in parts.LOG)
        self.assertAlmostEqual(volume(*parts.log()), cells * parts.LOG_DEPTH)

    def test_parts_are_valid_meshes(self):
        with tempfile.TemporaryDirectory() as directory:
            for name, characteristic in (("log", 2), ("link", 0)):
                path = proxies.fetch(f"part:{name}", PROGRAM, pathlib.Path(directory))
                measures = proxies.measures(PROGRAM, path)
                self.assertEqual(measures["boundary_edges"], 0)
                self.assertEqual(measures["vertices"] - measures["edges"] + measures["faces"], characteristic)
                proxies.run([PROGRAM, "check", path])  # raises unless it can be caged

    def test_pile_stands_over_the_origin_without_overlap(self):
        places, ground = parts.pile_places((1, 2, 3), (3, 3, 4))
        for number, place in enumerate(places):
            matrix = place["matrix"]
            middle = [sum(matrix[k][j] * x for j, x in enumerate((2, 2.5, 3.5, 1))) for k in range(3)]
            self.assertAlmostEqual(middle[0], 0)
            self.assertAlmostEqual(middle[1], 0)
            self.assertGreater(middle[2] - 0.5, ground + 1.0 * number)


    def test_united_copies_are_turned_and_moved(self):
        mesh = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]
        points, triangles = parts.united(mesh, [parts.place(0, 0, 0), parts.place(5, 6, 7, 90)])
        self.assertEqual(triangles, [(0, 1, 2), (3, 4, 5)])
        for found, expected in zip(points, [*mesh[0], (5, 6, 7), (5, 7, 7), (4, 6, 7)], strict=True):
            for x, y in zip(found, expected):
                self.assertAlmostEqual(x, y)


class Files(unittest.TestCase):
    def test_binary_files_are_read_as_they_are(self):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            text, binary = proxies.fetch("part:link", PROGRAM, directory), directory / "binary.ply"
            proxies.run([PROGRAM, "pose", text, "--twist", 0, "--format", "ply", "-o", binary])
            self.assertIn(b"format binary", binary.read_bytes())
            self.assertEqual(proxies.read_mesh(PROGRAM, binary, directory), parts.link())

    def test_off(self):
        points, triangles = proxies.read_off("OFF # a comment\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.assertEqual(points, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        self.assertEqual(triangles, [(0, 1, 2)])

    def test_off_with_a_quadrangle_is_refused(self):
        with self.assertRaises(proxies.Failure):
            proxies.read_off("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")

    def test_a_program_that_fails_says_why(self):
        with self.assertRaisesRegex(proxies.Failure, "no-such-shape"):
            proxies.run([PROGRAM, "make", "no-such-shape", "--faces", "100", "-o", "x.ply"])


class Results(unittest.TestCase):
    def test_only_the_frames_at_rest_count_for_the_energy(self):
        summary = results.summary(rows(lambda frame: frame - 100 if frame >= 100 else 1e9))
        self.assertEqual(summary["energy"], {"min": 0, "q1": 5, "median": 10, "q3": 15, "max": 20})

    def test_penetration_of_every_frame_counts(self):
        frames = rows(lambda frame: 1.0)
        frames[3] |= {"inside": 2, "depth": 0.01}
        summary = results.summary(frames)
        self.assertEqual((summary["frames_penetrated"], summary["depth"], summary["inside"]), (1, 0.01, 0))

    def test_departure(self):
        self.assertAlmostEqual(results.departure([(3, 4, 0), (0, 0, 0)], [(0, 0, 0), (0, 0, 0)]), 2.5)

    def test_table(self):
        run = {"faces": 12, "encloses": False, "points": 7, "frames": rows(lambda frame: 2.0, 0.25, 3, 0.0125)}
        run["summary"] = results.summary(run["frames"]) | {"departure": 0.5}
        self.assertEqual(results.table({"hull": run}).splitlines()[-1],
                         "| hull | 12 | no | 2 | 2 | 250.0 | 119 of 119 | 1.250 | 3.0 of 7 | 50.00 |")

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not there")
    def test_figure(self):
        run = {"frames": rows(lambda frame: 0 if frame == 110 else 1 / frame)}
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "figure.svg"
            results.figure([{"kind": "cloth", "name": "a", "runs": {"input": run, "a hull": run}}], path)
            self.assertTrue(path.read_text().rstrip().endswith("</svg>"))


if __name__ == "__main__":
    unittest.main()
