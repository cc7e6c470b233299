"""Makes bodies.FCStd: freecadcmd make_bodies.py. It is of FreeCAD 0.20.2 (Debian 12)."""
import os

import FreeCAD

VECTOR = FreeCAD.Vector


def place(x, y, z, axis=VECTOR(0, 0, 1), degrees=0):
    return FreeCAD.Placement(VECTOR(x, y, z), FreeCAD.Rotation(axis, degrees))


def box(document, name, label, size, at):
    body = document.addObject("Part::Box", name)
    body.Length, body.Width, body.Height = size
    body.Placement, body.Label = at, label
    return body


document = FreeCAD.newDocument("bodies")
# A body in a part in a part, all of them turned.
jaw = box(document, "Jaw", "Spannbacke \u00e4", (10, 20, 30), place(100, 0, 0, degrees=30))
inner = document.addObject("App::Part", "Inner")
inner.Placement, inner.Label = place(0, 50, 0, VECTOR(1, 0, 0), 90), "jaws"
inner.addObject(jaw)
outer = document.addObject("App::Part", "Outer")
outer.Placement, outer.Label = place(0, 0, 7, VECTOR(0, 1, 0), -20), "vise"
outer.addObject(inner)
outer.addObject(box(document, "Base", "base", (50, 40, 5), place(0, 0, 0)))
# A cut and what it is made of.
cylinder = document.addObject("Part::Cylinder", "Cylinder")
cylinder.Radius, cylinder.Height, cylinder.Placement = 5, 20, place(0, 0, -40)
sphere = document.addObject("Part::Sphere", "Sphere")
sphere.Radius, sphere.Placement = 8, place(5, 0, -30)
cut = document.addObject("Part::Cut", "Cut")
cut.Base, cut.Tool, cut.Placement = cylinder, sphere, place(1, 2, 3)
# A body made in steps.
body = document.addObject("PartDesign::Body", "Body")
body.Placement = place(-50, 0, 0)
block = document.addObject("PartDesign::AdditiveBox", "Block")
block.Length = block.Width = block.Height = 10
body.addObject(block)
document.recompute()
fillet = document.addObject("PartDesign::Fillet", "Fillet")
fillet.Base, fillet.Radius = (block, ["Edge1"]), 2
body.addObject(fillet)
# What is no body.
link = document.addObject("App::Link", "Link")
link.LinkedObject = jaw
group = document.addObject("App::DocumentObjectGroup", "Group")
group.Label = "copies"
group.addObject(link)
group.addObject(box(document, "Spare", "spare", (1, 2, 3), place(0, 0, 0)))
document.recompute()
document.saveAs(os.path.abspath("bodies.FCStd"))
cut.Shape.exportBrep("cut.brep")
cut.Shape.exportBinary("cut_binary.brep")
for each in (jaw, outer, inner, cut, body):
    print(each.Label, each.Shape.BoundBox, each.Shape.Volume)
