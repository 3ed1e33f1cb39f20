"""From what was measured frame by frame to a table and figures. Every row of `frames` is a frame of the simulation."""
import statistics
import subprocess

REST = (100, 120)       # the frames of the paper's Figs. 19 and 21
LEAST_ENERGY = 1e-9     # J: lower ones are drawn here, since 0 has no logarithm
COLUMNS = ("proxy", "faces", "encloses", "median KE, J", "largest KE, J", "ms a frame", "frames with penetration",
           "deepest, %", "inside, frames 100-120", "moved from the input's, %")


def at_rest(frames):
    return [row for row in frames if REST[0] <= row["frame"] <= REST[1]]


def quartiles(values):
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive")
    return {"min": min(values), "q1": low, "median": middle, "q3": high, "max": max(values)}


def departure(last, reference):
    """Mean distance of vertices or parts, at the last frame, from where the simulation with the input has them."""
    apart = [sum((x - y) ** 2 for x, y in zip(p, q)) ** 0.5 for p, q in zip(last, reference)]
    return statistics.mean(apart)


def summary(frames):
    """What the table says of one simulation. Depths are relative to the diagonal of the input."""
    rest = at_rest(frames)
    return {"energy": quartiles([row["energy"] for row in rest]),
            "seconds": statistics.median(row["seconds"] for row in frames),
            "frames_penetrated": sum(row["inside"] > 0 for row in frames),
            "depth": max(row["depth"] for row in frames),
            "inside": statistics.mean(row["inside"] for row in rest)}


# ------------------------------------------------------------------------------------------------------ table


def table(runs):
    """`runs`: those of one scene, by proxy."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "| --- |" + " ---: |" * (len(COLUMNS) - 1)]
    for name, run in runs.items():
        s, points = run["summary"], run["points"]
        cells = [name, str(run["faces"]), "" if run["encloses"] is None else "yes" if run["encloses"] else "no",
                 f"{s['energy']['median']:.3g}", f"{s['energy']['max']:.3g}", f"{1000 * s['seconds']:.1f}",
                 f"{s['frames_penetrated']} of {len(run['frames'])}", f"{100 * s['depth']:.3f}",
                 f"{s['inside']:.1f} of {points}", percent(s["departure"])]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def percent(value):
    """Of a departure; what is further away than its own size has not been held by anything."""
    return "" if value is None else "> 100" if value > 1 else f"{100 * value:.2f}"


def report(heading, scenes):
    parts = [heading]
    for scene in scenes:
        parts.append(f"**{scene['kind']}: {scene['name']}**, {scene['input_faces']:,} faces")
        parts.append(table(scene["runs"]))
        parts += [f"- {name}: no proxy: {cause}" for name, cause in scene["failed"].items()]
    return "\n\n".join(parts) + "\n"


# ---------------------------------------------------------------------------------------------------- figures


def block(name, lines):
    return [f"${name} << end", *lines, "end"]


def box_panel(scene, tag):
    """Box plots of the energy at rest, one a proxy."""
    script, plots, labels = [], [], []
    for i, (name, run) in enumerate(scene["runs"].items()):
        values = [f"{max(row['energy'], LEAST_ENERGY):g}" for row in at_rest(run["frames"])]
        script += block(f"{tag}box{i}", values)
        plots.append(f"${tag}box{i} using ({i + 1}):1 notitle linecolor {i + 1}")
        labels.append(f'"{name}" {i + 1}')
    return script + [f'set title "{scene["kind"]}: {scene["name"]}, frames {REST[0]} to {REST[1]}"',
                     "set style data boxplot", f"set xtics ({', '.join(labels)})", f"set xrange [0.4:{len(plots)}.6]",
                     "plot " + ", ".join(plots)]


def curve_panel(scene, tag):
    """The energy of every frame."""
    script, plots = [], []
    for i, (name, run) in enumerate(scene["runs"].items()):
        script += block(f"{tag}curve{i}", [f"{row['frame']} {max(row['energy'], LEAST_ENERGY):g}"
                                           for row in run["frames"]])
        plots.append(f'${tag}curve{i} using 1:2 with lines linewidth 1.5 linecolor {i + 1} notitle')
    return script + [f'set title "{scene["kind"]}: {scene["name"]}"', "set style data lines", "set xtics autofreq",
                     "set xrange [0:*]", "plot " + ", ".join(plots)]


def figure(scenes, path):
    """One row a scene: curves left, boxes right, which name the colours; logarithms of the energy in J."""
    height = 300 * len(scenes)
    script = [f'set terminal svg size 1000,{height} font "sans,12" background "white"', f'set output "{path}"',
              f"set multiplot layout {len(scenes)},2", "set logscale y", "set format y '10^{%L}'", "set grid y",
              'set ylabel "kinetic energy, J"', "set style boxplot nooutliers", "set boxwidth 0.5",
              'set xtics font ",10"', "set style fill solid 0.3"]
    for i, scene in enumerate(scenes):
        script += curve_panel(scene, f"s{i}") + box_panel(scene, f"s{i}")
    subprocess.run(["gnuplot"], input="\n".join(script) + "\nunset multiplot\n", text=True, check=True)
