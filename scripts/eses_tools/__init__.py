"""The tools around eses-blocks: eses-view, eses-render, eses-report, eses-pdbbind, eses-apbs, eses-assemble,
eses-traj.

Each tool is a module with a function start(). They need only the program; numpy and VTK are imported
where a tool needs them. `python -m eses_tools view ...` starts a tool, too.
"""

# Colours of the surface and drawings of atoms in pages.
SCHEMES = ("patch", "atom", "element", "chain", "residue", "area", "component", "potential", "file",
           "plain")
STYLES = ("none", "sticks", "balls", "spheres")
