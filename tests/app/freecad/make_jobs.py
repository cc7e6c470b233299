"""Makes the documents of this folder: freecadcmd make_jobs.py. They are of FreeCAD 0.20.2 (Debian 12)."""
import os

import FreeCAD
import PathScripts.PathJob as PathJob
import PathScripts.PathStock as PathStock
import PathScripts.PathToolBit as PathToolBit
import PathScripts.PathToolController as PathToolController

BITS = os.path.join(FreeCAD.getResourceDir(), "Mod", "Path", "Tools", "Bit")
VECTOR, TURN = FreeCAD.Vector, FreeCAD.Rotation()


def stock_of(kind, job):
    if kind == "box":
        return PathStock.CreateBox(job, VECTOR(60, 50, 20), FreeCAD.Placement(VECTOR(-5, -5, -8), TURN))
    if kind == "cylinder":
        return PathStock.CreateCylinder(job, 40, 25, FreeCAD.Placement(VECTOR(25, 20, 0), TURN))
    if kind == "own":
        bar = job.Document.addObject("Part::Cylinder", "Bar")
        bar.Radius, bar.Height = 12, 60
        bar.Placement = FreeCAD.Placement(VECTOR(-3, 20, 5), FreeCAD.Rotation(VECTOR(0, 1, 0), 90))
        job.Document.recompute()
        return PathJob.createResourceClone(job, bar, "Stock", "Stock")
    return PathStock.CreateFromBase(job, VECTOR(1, 2, 3), VECTOR(4, 5, 6))


for kind in ("box", "cylinder", "base", "own"):
    document = FreeCAD.newDocument("job_" + kind)
    part = document.addObject("Part::Box", "Box")
    part.Length, part.Width, part.Height = 50, 40, 10
    document.recompute()
    job = PathJob.Create("Job", [part], None)
    job.Stock = stock_of(kind, job)
    job.Fixtures = ["G54", "G55"]
    job.PostProcessor = "linuxcnc"
    for name, number in (("5mm_Endmill", 7), ("45degree_chamfer", 12)):
        bit = PathToolBit.Factory.CreateFrom(os.path.join(BITS, name + ".fctb"))
        job.Proxy.addToolController(PathToolController.Create("TC: " + name, tool=bit, toolNumber=number))
    document.recompute()
    document.saveAs(os.path.abspath(kind + ".FCStd"))
