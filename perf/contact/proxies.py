"""Inputs and their proxies: which programs make them, and what `prcage check` says of each."""
import hashlib
import json
import pathlib
import subprocess
import tarfile

import parts

# Name in the tables, program of perf/; the input itself comes first, prcage's cage second.
INPUT, CAGE = "input", "prcage"
RIVALS = (("convex hull", "prcage_rival_convex_hull"), ("CGAL wrap, simplified", "prcage_rival_wrap_simplify"))
SHAPE_FACES = 20000
CGAL_MESHES = pathlib.Path("/usr/share/doc/libcgal-demo/data.tar.gz")


class Failure(Exception):
    """A program that came to no result; the text is the cause."""


def run(command, codes=(0,)):
    process = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if process.returncode not in codes:
        said = (process.stderr.strip() or process.stdout.strip()).splitlines()
        raise Failure(" / ".join(said[-3:]) or f"{command[0]}: exit code {process.returncode}")
    return process.stdout


# ------------------------------------------------------------------------------------------------------ inputs


def write_ply(path, points, triangles):
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}",
            *(f"property double {axis}" for axis in "xyz"),
            f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    body = [" ".join(repr(float(x)) for x in p) for p in points] + ["3 %d %d %d" % tuple(t) for t in triangles]
    path.write_text("\n".join(head + body) + "\n", encoding="ascii")


def read_off(text):
    """The triangles of an OFF file. Polygons are refused: there is more than one way to cut them."""
    lines = (line.split("#")[0].split() for line in text.splitlines())
    words = [word for line in lines for word in line]
    if not words or words[0] != "OFF":
        raise Failure("not an OFF file")
    vertices, faces = int(words[1]), int(words[2])
    numbers = words[4:4 + 3 * vertices]
    points = [tuple(map(float, numbers[i:i + 3])) for i in range(0, len(numbers), 3)]
    rest = words[4 + 3 * vertices:]
    if len(points) != vertices or len(rest) != 4 * faces or any(rest[4 * i] != "3" for i in range(faces)):
        raise Failure("an OFF file with other faces than triangles, or with colours")
    return points, [tuple(map(int, rest[4 * i + 1:4 * i + 4])) for i in range(faces)]


def read_mesh(program, mesh, directory):
    """Of any file that prcage reads: a pose by no degrees is the same mesh."""
    path = directory / f"{pathlib.Path(mesh).stem}.off"
    run([program, "pose", mesh, "--twist", 0, "-o", path])
    return read_off(path.read_text(encoding="ascii"))


def fetch(mesh, program, directory):
    """The PLY file of a mesh: a file (PLY or OFF), `cgal:NAME` from Debian's libcgal-demo, `part:NAME` of parts.py, or
    the name of a shape of `prcage make`. Blender reads PLY, not OFF."""
    name = mesh.split(":")[-1]
    path = directory / f"{pathlib.Path(name).stem}.ply"
    if mesh.startswith("part:"):
        write_ply(path, *{"log": parts.log, "link": parts.link}[name]())
    elif mesh.startswith("cgal:"):
        with tarfile.open(CGAL_MESHES) as archive:
            write_ply(path, *read_off(archive.extractfile(f"data/meshes/{name}.off").read().decode("ascii")))
    elif mesh.endswith(".off"):
        write_ply(path, *read_off(pathlib.Path(mesh).read_text(encoding="ascii")))
    elif mesh.endswith(".ply"):
        path = pathlib.Path(mesh).resolve()
    else:
        run([program, "make", mesh, "--faces", SHAPE_FACES, "-o", path])
    return path


# ----------------------------------------------------------------------------------------------------- proxies


def judged(program, mesh, proxy):
    report = json.loads(run([program, "check", mesh, "--cage", proxy, "--json"], codes=(0, 6)))
    certificate = report["certificate"]
    return {"file": str(proxy), "faces": report["cage"]["faces"],
            "encloses": certificate["encloses"] and certificate["no_contact"],
            "topology_equal": certificate["euler_characteristic_equal"] and certificate["component_count_equal"]}


def measures(program, mesh):
    return json.loads(run([program, "info", mesh, "--json"]))["measures"]


def bounds(program, mesh):
    of_mesh = measures(program, mesh)
    return of_mesh["lower"], of_mesh["upper"]


def face_count(program, mesh):
    return measures(program, mesh)["faces"]


def digest(*files):
    return hashlib.sha256(b"".join(pathlib.Path(file).read_bytes() for file in files)).hexdigest()


def make_proxies(build, mesh, tau, directory):
    """Those of an earlier run, if neither the mesh nor a program has changed; new ones otherwise."""
    programs = [build / program for program in ("prcage", *(rival for _, rival in RIVALS))]
    key = [tau, digest(mesh, *programs)]
    record = directory / f"{mesh.stem}.proxies.json"
    known = json.loads(record.read_text()) if record.exists() else {}
    if known.get("key") != key:
        made, failed = new_proxies(build, mesh, tau, directory)
        known = {"key": key, "made": made, "failed": failed}
        record.write_text(json.dumps(known))
    return known["made"], known["failed"]


def new_proxies(build, mesh, tau, directory):
    """The cage as coarse as tau allows, and the rivals of at most as many faces; a rival without a result is left
    out, and said so in `failed`."""
    program = build / "prcage"
    cage = directory / f"{mesh.stem}-cage.ply"
    run([program, "cage", mesh, "-o", cage, "--tau", tau, "--quiet"])
    made = {CAGE: judged(program, mesh, cage)}
    failed = {}
    for name, rival in RIVALS:
        proxy = directory / f"{mesh.stem}-{rival}.ply"
        try:
            run([build / rival, mesh, made[CAGE]["faces"], proxy])
            made[name] = judged(program, mesh, proxy)
        except Failure as failure:
            failed[name] = str(failure)
    return made, failed
