#include "core/cad/reader/document.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include <BRepAdaptor_Curve.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <BinTools.hxx>
#include <BinTools_ShapeSet.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <Message_ProgressScope.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/file_reads.h"
#include "core/cad/reader/completeness.h"
#include "core/formats/freecad_document.h"

namespace core::cad {

namespace {

constexpr size_t largest_shape = size_t{256} << 20U; // of an object in an archive, bytes

/// The name of a label; empty if it has none.
std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    const TCollection_AsciiString text(name->Get());
    std::string own = plain_name({text.ToCString(), static_cast<size_t>(text.Length())});
    return own.starts_with("=>[") ? std::string() : own; // which Open CASCADE invents
}

/// The number of shapes of a kind outside of shapes of another kind.
size_t count_outside(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind, TopAbs_ShapeEnum outside) {
    size_t count = 0;
    for (TopExp_Explorer e(shape, kind, outside); e.More(); e.Next()) ++count;
    return count;
}

std::string place_of_edge(const TopoDS_Edge& edge) {
    const BRepAdaptor_Curve curve(edge);
    const gp_Pnt a = curve.Value(curve.FirstParameter()), b = curve.Value(curve.LastParameter());
    return fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", a.X(), a.Y(), a.Z(),
                       b.X(), b.Y(), b.Z());
}

/// Faces that belong to no solid, joined.
struct Sewn {
    std::vector<TopoDS_Shape> solids;
    size_t open_pieces = 0; // that enclose nothing
    size_t open_edges = 0;
    std::string open_edge; // where one of them is
};

TopoDS_Shell shell_of(const TopoDS_Shape& face) {
    TopoDS_Shell shell;
    BRep_Builder builder;
    builder.MakeShell(shell);
    builder.Add(shell, face);
    return shell;
}

TopoDS_Shape solid_of(const TopoDS_Shell& shell) {
    TopoDS_Solid solid;
    BRep_Builder builder;
    builder.MakeSolid(solid);
    builder.Add(solid, shell);
    return solid;
}

Sewn sewn(const TopoDS_Shape& shape, double tolerance) {
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (TopExp_Explorer e(shape, TopAbs_FACE, TopAbs_SOLID); e.More(); e.Next())
        sewing.Add(e.Current());
    sewing.Perform();
    Sewn result;
    result.open_edges = static_cast<size_t>(sewing.NbFreeEdges());
    if (result.open_edges > 0) result.open_edge = place_of_edge(sewing.FreeEdge(1));
    const auto add = [&](const TopoDS_Shell& shell) {
        if (BRep_Tool::IsClosed(shell))
            result.solids.push_back(solid_of(shell));
        else
            ++result.open_pieces;
    };
    const TopoDS_Shape all = sewing.SewedShape();
    for (TopExp_Explorer e(all, TopAbs_SHELL); e.More(); e.Next()) add(TopoDS::Shell(e.Current()));
    // A face alone, such as a whole sphere.
    for (TopExp_Explorer e(all, TopAbs_FACE, TopAbs_SHELL); e.More(); e.Next())
        add(shell_of(e.Current()));
    return result;
}

/// Where a shape stands in the assembly.
struct Context {
    std::vector<std::string> names;
    std::optional<Colour> colour;
    TopLoc_Location place;
    int depth = 0;
};

/// Collects the solids of shapes.
class Collector {
public:
    /// Completes what is known of a solid: its names, its colour.
    using Finish = std::function<void(const TopoDS_Shape& solid, PlacedSolid& placed)>;

    explicit Collector(double sewing) : sewing_(sewing) {}

    /// Adds the solids of a shape, and those that its other faces enclose. `finish` may be empty.
    void add(const TopoDS_Shape& shape, const Context& context, const Finish& finish);
    void leave_out(CadSurfaces what) { document_.left_out.push_back(std::move(what)); }

    Result<Document> result();

private:
    void add_solids(const Context& context, const std::vector<TopoDS_Shape>& solids,
                    const Finish& finish);
    void make_names_unique();
    Result<Document> nothing() const;

    double sewing_;
    Document document_;
    std::string open_part_, open_edge_; // a part with an open surface
    size_t open_edges_ = 0;
    size_t curves_ = 0;
};

void Collector::add_solids(const Context& context, const std::vector<TopoDS_Shape>& solids,
                           const Finish& finish) {
    for (const TopoDS_Shape& solid : solids) {
        PlacedSolid placed;
        placed.names = context.names;
        placed.colour = context.colour;
        placed.shape = solid.Located(TopLoc_Location());
        placed.place = (context.place * solid.Location()).Transformation();
        if (finish) finish(solid, placed);
        if (placed.names.empty()) placed.names.emplace_back("solid");
        document_.solids.push_back(std::move(placed));
    }
}

void Collector::add(const TopoDS_Shape& shape, const Context& context, const Finish& finish) {
    if (shape.IsNull()) return;
    std::vector<TopoDS_Shape> solids;
    for (TopExp_Explorer e(shape, TopAbs_SOLID); e.More(); e.Next()) solids.push_back(e.Current());
    add_solids(context, solids, finish);
    curves_ += count_outside(shape, TopAbs_EDGE, TopAbs_FACE);
    const size_t faces = count_outside(shape, TopAbs_FACE, TopAbs_SOLID);
    if (faces == 0) return;
    const std::string name = context.names.empty() ? "the file" : context.names.back();
    const Sewn found = sewn(shape, sewing_);
    add_solids(context, found.solids, finish);
    if (!found.solids.empty())
        document_.notes.push_back(fmt::format(
            "{}: its surfaces are no solid and were joined, across gaps of up to {:g} mm", name,
            sewing_));
    if (found.open_pieces == 0 && !found.solids.empty()) return;
    leave_out(
        {context.names, fmt::format("{} has {} that {} no solid", name,
                                    faces == 1 ? "a surface" : fmt::format("{} surfaces", faces),
                                    faces == 1 ? "encloses" : "enclose")});
    if (!open_part_.empty()) return;
    open_part_ = name;
    open_edge_ = found.open_edge;
    open_edges_ = found.open_edges;
}

/// Gives each solid a last name of its own: "bolt", "bolt (2)", ...
void Collector::make_names_unique() {
    std::set<std::string> taken;
    for (const PlacedSolid& solid : document_.solids)
        taken.insert(solid.names.begin(), solid.names.end());
    std::map<std::string, size_t> count;
    for (const PlacedSolid& solid : document_.solids) ++count[solid.names.back()];
    std::map<std::string, size_t> next;
    for (PlacedSolid& solid : document_.solids) {
        const std::string name = solid.names.back();
        if (count[name] == 1) continue;
        size_t& number = next[name];
        std::string own;
        do own = fmt::format("{} ({})", name, ++number);
        while (!taken.insert(own).second);
        solid.names.push_back(own);
    }
}

/// Why a file has no solids.
Result<Document> Collector::nothing() const {
    if (open_edges_ > 0)
        return fail(ErrorCode::invalid_value,
                    fmt::format("{} has an open surface and no solid: {} {} a face on one side "
                                "only, one of them from {}; close it in the CAD system, or export "
                                "a solid",
                                open_part_, open_edges_,
                                open_edges_ == 1 ? "edge has" : "edges have", open_edge_));
    if (!open_part_.empty())
        return fail(
            ErrorCode::invalid_value,
            fmt::format("{} has surfaces that enclose no solid: export a solid", open_part_));
    if (curves_ > 0)
        return fail(ErrorCode::invalid_value,
                    "it has curves and no surfaces: export the body as a solid");
    std::vector<std::string> reasons;
    for (const CadSurfaces& surfaces : document_.left_out) reasons.push_back(surfaces.what);
    if (!reasons.empty())
        return fail(ErrorCode::invalid_value,
                    fmt::format("it has no bodies that can be read: {}", fmt::join(reasons, "; ")));
    return fail(ErrorCode::missing_value, "it has no bodies");
}

Result<Document> Collector::result() {
    if (document_.solids.empty()) return nothing();
    if (curves_ > 0)
        document_.notes.push_back(
            fmt::format("{} {} left out", curves_, curves_ == 1 ? "curve is" : "curves are"));
    make_names_unique();
    return std::move(document_);
}

/// The solids of a document of Open CASCADE, as its readers of STEP and IGES make it.
class Assembly {
public:
    Assembly(const Handle(TDocStd_Document) & document, const SolidNames& names, double sewing)
        : names_(names),
          shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
          colours_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
          collector_(sewing) {}

    Result<Document> collect();

private:
    void add(const TDF_Label& label, Context context);
    void add_part(const TDF_Label& label, const Context& context);
    void finish(const TDF_Label& label, const TopoDS_Shape& solid, bool is_alone,
                PlacedSolid& placed) const;
    void take_names(const TDF_Label& label, Context& context) const;
    template <typename Coloured> // a label or a shape
    std::optional<Colour> colour_of(const Coloured& coloured) const;

    const SolidNames& names_;
    Handle(XCAFDoc_ShapeTool) shapes_;
    Handle(XCAFDoc_ColorTool) colours_;
    Collector collector_;
    bool is_too_deep_ = false;
};

Colour bytes_of(const Quantity_Color& colour) {
    double red = 0.0, green = 0.0, blue = 0.0;
    colour.Values(red, green, blue, Quantity_TOC_sRGB);
    const auto byte = [](double part) {
        return static_cast<uint8_t>(std::clamp(255.0 * part + 0.5, 0.0, 255.0));
    };
    return {byte(red), byte(green), byte(blue)};
}

template <typename Coloured>
std::optional<Colour> Assembly::colour_of(const Coloured& coloured) const {
    Quantity_Color colour;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
        if (colours_->GetColor(coloured, type, colour)) return bytes_of(colour);
    return std::nullopt;
}

void Assembly::take_names(const TDF_Label& label, Context& context) const {
    const std::string name = name_of(label);
    const auto known = std::find(context.names.begin(), context.names.end(), name);
    if (!name.empty() && known == context.names.end()) context.names.push_back(name);
}

void Assembly::add(const TDF_Label& label, Context context) {
    constexpr int deepest = 100; // a file can nest an assembly in itself
    if (context.depth > deepest) {
        is_too_deep_ = true;
        return;
    }
    ++context.depth;
    take_names(label, context);
    if (const auto colour = colour_of(label)) context.colour = colour;
    TDF_Label part = label;
    if (XCAFDoc_ShapeTool::IsReference(label)) {
        context.place = context.place * XCAFDoc_ShapeTool::GetLocation(label);
        XCAFDoc_ShapeTool::GetReferredShape(label, part);
        take_names(part, context);
        if (!context.colour) context.colour = colour_of(part);
    }
    if (!XCAFDoc_ShapeTool::IsAssembly(part)) return add_part(part, context);
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(part, components);
    for (const TDF_Label& component : components) add(component, context);
}

void Assembly::finish(const TDF_Label& label, const TopoDS_Shape& solid, bool is_alone,
                      PlacedSolid& placed) const {
    for (const SolidName& own : names_)
        if (!is_alone && own.solid.IsPartner(solid)) placed.names.push_back(own.name);
    TDF_Label own;
    if (shapes_->FindSubShape(label, solid, own))
        if (const auto colour = colour_of(own)) placed.colour = colour;
    if (!placed.colour) placed.colour = colour_of(solid);
    TopExp_Explorer face(solid, TopAbs_FACE);
    if (!placed.colour && face.More()) placed.colour = colour_of(face.Current());
}

void Assembly::add_part(const TDF_Label& label, const Context& context) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    const bool is_alone = count_outside(shape, TopAbs_SOLID, TopAbs_SHAPE) == 1;
    collector_.add(shape, context, [&](const TopoDS_Shape& solid, PlacedSolid& placed) {
        finish(label, solid, is_alone, placed);
    });
}

Result<Document> Assembly::collect() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) add(root, {});
    if (is_too_deep_)
        return fail(ErrorCode::invalid_value, "its assemblies are nested more than 100 deep");
    return collector_.result();
}

tl::unexpected<Error> fail_reading(IFSelect_ReturnStatus status, const char* format) {
    return fail(ErrorCode::syntax,
                status == IFSelect_RetVoid
                    ? fmt::format("it has no contents that {} defines", format)
                    : fmt::format("it is damaged, or no {} file: export it again", format));
}

Result<SolidNames> read_step(const std::string& path, Handle(TDocStd_Document) & document,
                             const Message_ProgressRange& progress) {
    STEPCAFControl_Reader reader;
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    // Otherwise a coordinate system beside a body moves it.
    Interface_Static::SetCVal("read.step.root.transformation", "OFF");
    reader.SetNameMode(true);
    reader.SetColorMode(true);
    reader.SetLayerMode(false);
    reader.SetPropsMode(false);
    reader.SetGDTMode(false);
    reader.SetMatMode(false);
    const IFSelect_ReturnStatus status = reader.ReadFile(path.c_str());
    if (status != IFSelect_RetDone) return fail_reading(status, "STEP");
    const Handle(XSControl_WorkSession) session = reader.Reader().WS();
    FEELER_TRY([[maybe_unused]] const bool is_whole, check_step(session));
    if (!reader.Transfer(document, progress))
        return fail(ErrorCode::invalid_value, "it has no bodies that Open CASCADE can read");
    return names_of_solids(session);
}

Result<SolidNames> read_iges(const std::string& path, Handle(TDocStd_Document) & document,
                             const Message_ProgressRange& progress) {
    IGESCAFControl_Reader reader;
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    reader.SetNameMode(true);
    reader.SetColorMode(true);
    reader.SetLayerMode(false);
    const IFSelect_ReturnStatus status = reader.ReadFile(path.c_str());
    if (status != IFSelect_RetDone) return fail_reading(status, "IGES");
    FEELER_TRY([[maybe_unused]] const bool is_whole, check_entities(reader.WS()->Model()));
    if (!reader.Transfer(document, progress))
        return fail(ErrorCode::invalid_value, "it has no bodies that Open CASCADE can read");
    FEELER_TRY([[maybe_unused]] const bool all, check_transferred_iges(reader.WS()));
    return SolidNames{};
}

/// A binary shape. Which of the shapes in it is meant, Open CASCADE states in 9 bytes at its end,
/// FreeCAD in 12: index, place and orientation as whole numbers.
TopoDS_Shape binary_shape_in(std::istringstream& stream, size_t size,
                             const Message_ProgressRange& progress) {
    BinTools_ShapeSet shapes;
    shapes.Read(stream, progress);
    const auto at = static_cast<size_t>(std::max<std::streamoff>(stream.tellg(), 0));
    TopoDS_Shape shape;
    constexpr size_t of_freecad = 3 * sizeof(Standard_Integer);
    if (at + of_freecad != size) {
        shapes.ReadSubs(shape, stream, shapes.NbShapes());
        return shape;
    }
    Standard_Integer index = 0, place = 0, orientation = 0;
    for (Standard_Integer* number : {&index, &place, &orientation})
        BinTools::GetInteger(stream, *number);
    shape = shapes.Shape(index);
    shape.Location(shapes.Locations().Location(place));
    shape.Orientation(orientation == TopAbs_REVERSED ? TopAbs_REVERSED : TopAbs_FORWARD);
    return shape;
}

/// A shape as Open CASCADE stores it, as text or binary; null if it is damaged.
TopoDS_Shape shape_in(const std::string& bytes, const Message_ProgressRange& progress) {
    constexpr size_t head = 64;
    std::istringstream stream(bytes);
    // Open CASCADE goes on reading after the end of a damaged file, billions of times.
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    try {
        if (bytes.substr(0, head).find("Open CASCADE Topology") != std::string::npos)
            return binary_shape_in(stream, bytes.size(), progress);
        TopoDS_Shape shape;
        BRepTools::Read(shape, stream, BRep_Builder(), progress);
        return shape;
    } catch (const Standard_Failure&) {
        return {};
    } catch (const std::ios_base::failure&) {
        return {};
    }
}

Result<Document> read_brep(const std::string& path, double sewing,
                           const Message_ProgressRange& progress) {
    const auto bytes = file_bytes(path);
    if (!bytes) return fail(ErrorCode::io, "it cannot be read");
    const TopoDS_Shape shape = shape_in(*bytes, progress);
    if (shape.IsNull()) return fail(ErrorCode::syntax, "it is damaged: export it again");
    Collector collector(sewing);
    collector.add(shape, {}, {});
    return collector.result();
}

gp_Trsf motion_of(const Transform& transform) {
    const Mat3& r = transform.rotation;
    const Vec3& t = transform.translation;
    gp_Trsf motion;
    motion.SetValues(r[0].x, r[1].x, r[2].x, t.x, r[0].y, r[1].y, r[2].y, t.y, r[0].z, r[1].z,
                     r[2].z, t.z);
    return motion;
}

Result<Document> read_freecad(const std::string& path, double sewing,
                              const Message_ProgressRange& progress) {
    FEELER_TRY(const FreeCadDocument document, FreeCadDocument::read(path));
    const std::vector<FreeCadBody> bodies = document.bodies();
    Message_ProgressScope scope(progress, "", static_cast<double>(bodies.size()));
    Collector collector(sewing);
    for (const FreeCadBody& body : bodies) {
        const Message_ProgressRange part = scope.Next();
        if (!body.why_left_out.empty()) {
            collector.leave_out({body.names, body.why_left_out});
            continue;
        }
        const auto bytes = document.archive().read(body.shape, largest_shape);
        const TopoDS_Shape shape = bytes ? shape_in(*bytes, part) : TopoDS_Shape();
        if (shape.IsNull()) {
            const char* const why = bytes && bytes->empty()
                                        ? " has no shape: recompute the document in FreeCAD"
                                        : " has a damaged shape";
            collector.leave_out({body.names, body.names.back() + why});
            continue;
        }
        if (!TopExp_Explorer(shape, TopAbs_FACE).More()) continue; // a sketch
        Context context;
        context.names = body.names;
        context.place = TopLoc_Location(motion_of(body.place));
        collector.add(shape, context, {});
    }
    return collector.result();
}

} // namespace

Result<Document> read_document(const std::string& path, CadFormat format, double sewing,
                               const Message_ProgressRange& progress) {
    if (format == CadFormat::brep) return read_brep(path, sewing, progress);
    if (format == CadFormat::freecad) return read_freecad(path, sewing, progress);
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    FEELER_TRY(const SolidNames names, format == CadFormat::step
                                           ? read_step(path, document, progress)
                                           : read_iges(path, document, progress));
    return Assembly(document, names, sewing).collect();
}

} // namespace core::cad
