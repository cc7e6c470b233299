#include "tests/cad/cad_models.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <Geom_BSplineCurve.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>

namespace test_support {

namespace {

using core::Vec3;

gp_Pnt point(const Vec3& p) { return {p.x, p.y, p.z}; }
gp_Vec vector(const Vec3& v) { return {v.x, v.y, v.z}; }

TopoDS_Wire circle_wire(double z, double radius) {
    const gp_Ax2 axes(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1));
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(axes, radius)));
}

TopoDS_Wire ellipse_wire(double z, double a, double b) {
    const gp_Ax2 axes(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1));
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Elips(axes, a, b)));
}

TopoDS_Wire square_wire(double z, double half) {
    return BRepBuilderAPI_MakePolygon(gp_Pnt(-half, -half, z), gp_Pnt(half, -half, z),
                                      gp_Pnt(half, half, z), gp_Pnt(-half, half, z), true);
}

TopoDS_Shape loft(const std::vector<TopoDS_Wire>& wires) {
    BRepOffsetAPI_ThruSections sections(true, false);
    for (const TopoDS_Wire& wire : wires) sections.AddWire(wire);
    return sections.Shape();
}

Handle(Geom_BSplineCurve) spline(const std::vector<Vec3>& through) {
    TColgp_Array1OfPnt points(1, static_cast<int>(through.size()));
    for (int i = 1; i <= points.Length(); ++i)
        points(i) = point(through[static_cast<size_t>(i - 1)]);
    return GeomAPI_PointsToBSpline(points).Curve();
}

/// A face in the XZ plane between a curve and the axis Z, turned about it.
TopoDS_Shape revolved_spline() {
    const Handle(Geom_BSplineCurve) side =
        spline({{10, 0, 0}, {14, 0, 6}, {8, 0, 13}, {11, 0, 20}});
    BRepBuilderAPI_MakeWire wire;
    wire.Add(BRepBuilderAPI_MakeEdge(side));
    wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(11, 0, 20), gp_Pnt(0, 0, 20)));
    wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 20), gp_Pnt(0, 0, 0)));
    wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)));
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()),
                                 gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)));
}

TopoDS_Shape extruded_spline() {
    BRepBuilderAPI_MakeWire wire;
    wire.Add(BRepBuilderAPI_MakeEdge(spline({{0, 0, 0}, {5, -4, 0}, {12, 3, 0}, {20, 1, 0}})));
    wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(20, 1, 0), gp_Pnt(10, 30, 0)));
    wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(10, 30, 0), gp_Pnt(0, 0, 0)));
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire.Wire()), gp_Vec(1, 2, 15));
}

TopoDS_Shape all_fillets(const TopoDS_Shape& shape, double radius) {
    BRepFilletAPI_MakeFillet fillet(shape);
    for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next())
        fillet.Add(radius, TopoDS::Edge(e.Current()));
    return fillet.Shape();
}

/// A cup: the wall is an offset of the outside.
TopoDS_Shape cup(const TopoDS_Shape& shape, double wall) {
    TopoDS_Face top;
    double highest = -1e9;
    for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) {
        const BRepAdaptor_Surface surface(TopoDS::Face(e.Current()));
        const double z = surface.GetType() == GeomAbs_Plane ? surface.Plane().Location().Z() : -1e9;
        if (z > highest) top = TopoDS::Face(e.Current()), highest = z;
    }
    TopTools_ListOfShape open;
    open.Append(top);
    BRepOffsetAPI_MakeThickSolid maker;
    maker.MakeThickSolidByJoin(shape, open, -wall, 1e-3);
    return maker.Shape();
}

TopoDS_Shape nurbs(const TopoDS_Shape& shape) { return BRepBuilderAPI_NurbsConvert(shape).Shape(); }

TopoDS_Shape stretched(const TopoDS_Shape& shape, const Vec3& by) {
    gp_GTrsf scale;
    for (int i = 1; i <= 3; ++i) scale.SetValue(i, i, by[i - 1]);
    return BRepBuilderAPI_GTransform(shape, scale).Shape();
}

TopoDS_Shape mirrored(const TopoDS_Shape& shape) {
    gp_Trsf mirror;
    mirror.SetMirror(gp_Ax2(gp_Pnt(5, 0, 0), gp_Dir(1, 0.2, 0)));
    return BRepBuilderAPI_Transform(shape, mirror).Shape();
}

TopoDS_Shape bored_block() {
    const TopoDS_Shape block = all_fillets(cad_box(Vec3(0), Vec3(40, 30, 20)), 3.0);
    const TopoDS_Shape bore =
        cad_moved(cad_turned(cad_cylinder(6, 80), Vec3(1, 1, 0), 35), Vec3(10, 20, -20));
    const TopoDS_Shape ball = cad_moved(BRepPrimAPI_MakeSphere(9).Shape(), Vec3(32, 8, 22));
    return BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(block, bore).Shape(), ball).Shape();
}

} // namespace

TopoDS_Shape cad_box(const Vec3& low, const Vec3& high) {
    return BRepPrimAPI_MakeBox(point(low), point(high)).Shape();
}

TopoDS_Shape cad_cylinder(double radius, double height) {
    return BRepPrimAPI_MakeCylinder(radius, height).Shape();
}

TopoDS_Shape cad_moved(const TopoDS_Shape& shape, const Vec3& by) {
    gp_Trsf move;
    move.SetTranslation(vector(by));
    return BRepBuilderAPI_Transform(shape, move).Shape();
}

TopoDS_Shape cad_turned(const TopoDS_Shape& shape, const Vec3& axis, double degrees) {
    gp_Trsf turn;
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(vector(axis))), degrees * M_PI / 180.0);
    return BRepBuilderAPI_Transform(shape, turn).Shape();
}

TopoDS_Shape cad_compound(const std::vector<TopoDS_Shape>& shapes) {
    TopoDS_Compound all;
    BRep_Builder builder;
    builder.MakeCompound(all);
    for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
    return all;
}

TopoDS_Shape cad_open_shell(const TopoDS_Shape& shape, size_t missing) {
    TopoDS_Shell shell;
    BRep_Builder builder;
    builder.MakeShell(shell);
    for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next())
        if (missing > 0)
            --missing;
        else
            builder.Add(shell, e.Current());
    return shell;
}

TopoDS_Shape cad_wires(const TopoDS_Shape& shape) {
    std::vector<TopoDS_Shape> edges;
    for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next()) edges.push_back(e.Current());
    return cad_compound(edges);
}

namespace {

TopoDS_Shape plain_box() { return cad_box(Vec3(-5, 0, 2), Vec3(15, 30, 12)); }

TopoDS_Shape crossed_cylinders() {
    return BRepAlgoAPI_Fuse(cad_moved(cad_cylinder(8, 40), Vec3(0, 0, -20)),
                            cad_turned(cad_cylinder(5, 30), Vec3(1, 0.3, 0), 80))
        .Shape();
}

TopoDS_Shape vase() {
    return loft(
        {circle_wire(0, 10), ellipse_wire(12, 14, 7), circle_wire(25, 6), circle_wire(30, 9)});
}

TopoDS_Shape cone(double low, double high, double height) {
    return BRepPrimAPI_MakeCone(low, high, height).Shape();
}

TopoDS_Shape cut_cone() {
    const TopoDS_Shape box = cad_box(Vec3(-20, -20, 4), Vec3(20, 20, 30));
    return BRepAlgoAPI_Cut(cone(10, 2, 15), cad_turned(box, Vec3(1, 0.2, 0), 30)).Shape();
}

TopoDS_Shape bored_cone() {
    const TopoDS_Shape bore = cad_turned(cad_cylinder(3, 40), Vec3(1, 0, 0), 90);
    return BRepAlgoAPI_Cut(cone(10, 2, 15), cad_moved(bore, Vec3(1, 20, 6))).Shape();
}

/// What two copies of a shape have in common that are moved by this to either side.
TopoDS_Shape lens(const TopoDS_Shape& shape, double aside) {
    return BRepAlgoAPI_Common(cad_moved(shape, Vec3(aside, 0, 0)),
                              cad_moved(shape, Vec3(-aside, 0, 0)))
        .Shape();
}

TopoDS_Shape blade_on_block() {
    return BRepAlgoAPI_Fuse(cad_box(Vec3(-3, -6, -5), Vec3(3, 6, 2)),
                            lens(cad_cylinder(20, 15), 19.9))
        .Shape();
}

TopoDS_Shape common_of_spheres() {
    const TopoDS_Shape other = cad_moved(BRepPrimAPI_MakeSphere(9).Shape(), Vec3(8, 3, 2));
    return BRepAlgoAPI_Common(BRepPrimAPI_MakeSphere(12).Shape(), other).Shape();
}

} // namespace

std::vector<CadModel> cad_models() {
    const auto sphere = [] { return BRepPrimAPI_MakeSphere(12).Shape(); };
    const auto torus = [] { return BRepPrimAPI_MakeTorus(12, 4).Shape(); };
    const auto filleted = [] { return all_fillets(plain_box(), 2.0); };
    return {
        {"box", plain_box},
        {"cylinder", [] { return cad_cylinder(7, 25); }},
        {"tiny cylinder", [] { return cad_cylinder(0.05, 0.2); }},
        {"cone", [] { return cone(10, 4, 12); }},
        {"pointed cone", [] { return cone(10, 0, 12); }},
        {"cut cone", cut_cone},
        {"bored cone", bored_cone},
        {"sphere", sphere},
        {"half sphere", [] { return BRepPrimAPI_MakeSphere(12, 0.3, M_PI / 2).Shape(); }},
        {"wedge of a sphere", [] { return BRepPrimAPI_MakeSphere(12, -0.4, 1.2, 2.0).Shape(); }},
        {"torus", torus},
        {"part of a torus", [] { return BRepPrimAPI_MakeTorus(12, 4, 0.4, 2.6, 1.5).Shape(); }},
        {"filleted box", filleted},
        {"crossed cylinders", crossed_cylinders},
        {"filleted bar", [] { return all_fillets(cad_box(Vec3(0), Vec3(30, 8, 8)), 3.9); }},
        {"bored block", bored_block},
        {"vase", vase},
        {"square to round",
         [] {
             return loft({square_wire(0, 10), square_wire(10, 7), square_wire(22, 12)});
         }},
        {"revolved spline", revolved_spline},
        {"extruded spline", extruded_spline},
        {"cup", [] { return cup(vase(), 1.2); }},
        {"cup of a box", [] { return cup(plain_box(), 1.5); }},
        {"box as nurbs", [=] { return nurbs(filleted()); }},
        {"sphere as nurbs", [=] { return nurbs(sphere()); }},
        {"torus as nurbs", [=] { return nurbs(torus()); }},
        {"cone as nurbs", [] { return nurbs(cone(10, 0, 12)); }},
        {"block as nurbs", [] { return nurbs(bored_block()); }},
        {"stretched torus", [=] { return stretched(torus(), Vec3(1, 2, 0.5)); }},
        {"mirrored block", [] { return mirrored(bored_block()); }},
        {"far vase", [] { return cad_moved(vase(), Vec3(20000, -3000, 500)); }},
        {"common of spheres", common_of_spheres},
        {"thin lens", [] { return lens(BRepPrimAPI_MakeSphere(20).Shape(), 19.9); }},
        {"thin blade", [] { return lens(cad_cylinder(20, 15), 19.9); }},
        {"blade on a block", blade_on_block},
    };
}

double cad_distance(const TopoDS_Shape& shape, const Vec3& p) {
    const TopoDS_Vertex vertex = BRepBuilderAPI_MakeVertex(point(p));
    BRepExtrema_DistShapeShape extrema(vertex, shape);
    if (!extrema.IsDone()) throw std::runtime_error("Open CASCADE finds no distance");
    return extrema.Value();
}

std::vector<Vec3> cad_surface_points(const TopoDS_Shape& shape, int count) {
    std::vector<Vec3> points;
    for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) {
        const TopoDS_Face face = TopoDS::Face(e.Current());
        double u0 = 0.0, u1 = 0.0, v0 = 0.0, v1 = 0.0;
        BRepTools::UVBounds(face, u0, u1, v0, v1);
        const BRepAdaptor_Surface surface(face);
        BRepTopAdaptor_FClass2d inside(face, 1e-9);
        for (int i = 0; i <= count; ++i)
            for (int k = 0; k <= count; ++k) {
                const gp_Pnt2d uv(u0 + (u1 - u0) * i / count, v0 + (v1 - v0) * k / count);
                if (inside.Perform(uv) == TopAbs_OUT) continue;
                const gp_Pnt p = surface.Value(uv.X(), uv.Y());
                points.emplace_back(p.X(), p.Y(), p.Z());
            }
    }
    return points;
}

void write_step(const std::filesystem::path& path, const TopoDS_Shape& shape,
                const std::string& unit) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    STEPControl_Writer writer;
    Interface_Static::SetCVal("write.step.unit", unit.c_str());
    writer.Transfer(shape, STEPControl_AsIs);
    writer.Write(path.c_str());
    Interface_Static::SetCVal("write.step.unit", "MM");
}

namespace {

class AssemblyWriter {
public:
    AssemblyWriter() {
        XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document_);
        shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
        colours_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    }

    TDF_Label add(const CadPart& part) {
        TDF_Label label;
        if (part.parts.empty()) {
            label = shapes_->AddShape(part.shape, false);
        } else {
            label = shapes_->NewShape();
            for (const CadPart& child : part.parts)
                shapes_->AddComponent(label, add(child), placed(child));
        }
        TDataStd_Name::Set(label, part.name.c_str());
        if (part.colour) {
            const auto& [r, g, b] = *part.colour;
            colours_->SetColor(label, Quantity_Color(r, g, b, Quantity_TOC_sRGB),
                               XCAFDoc_ColorSurf);
        }
        return label;
    }

    void write(const std::filesystem::path& path) {
        shapes_->UpdateAssemblies();
        STEPCAFControl_Writer writer;
        writer.Transfer(document_);
        writer.Write(path.c_str());
    }

private:
    static TopLoc_Location placed(const CadPart& part) {
        gp_Trsf turn, move;
        turn.SetRotation(gp::OZ(), part.turned * M_PI / 180.0);
        move.SetTranslation(vector(part.at));
        return move * turn;
    }

    Handle(TDocStd_Document) document_;
    Handle(XCAFDoc_ShapeTool) shapes_;
    Handle(XCAFDoc_ColorTool) colours_;
};

} // namespace

void write_step(const std::filesystem::path& path, const CadPart& assembly) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    AssemblyWriter writer;
    writer.add(assembly);
    writer.write(path);
}

void write_iges(const std::filesystem::path& path, const TopoDS_Shape& shape, bool as_solid) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    IGESControl_Writer writer("MM", as_solid ? 1 : 0);
    writer.AddShape(shape);
    writer.ComputeModel();
    writer.Write(path.c_str());
}

} // namespace test_support
