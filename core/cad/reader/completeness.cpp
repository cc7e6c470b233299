#include "core/cad/reader/completeness.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESGeom_BSplineSurface.hxx>
#include <IGESGeom_BoundedSurface.hxx>
#include <IGESGeom_CurveOnSurface.hxx>
#include <IGESGeom_SurfaceOfRevolution.hxx>
#include <IGESGeom_TransformationMatrix.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSolid_Face.hxx>
#include <IGESSolid_Loop.hxx>
#include <IGESSolid_ManifoldSolid.hxx>
#include <IGESSolid_Shell.hxx>
#include <Interface_Check.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_SiUnitAndLengthUnit.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepGeom_Plane.hxx>
#include <StepGeom_Point.hxx>
#include <StepGeom_RectangularTrimmedSurface.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentedDefinition.hxx>
#include <StepRepr_ShapeRepresentationRelationship.hxx>
#include <StepShape_BrepWithVoids.hxx>
#include <StepShape_ClosedShell.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_HArray1OfOrientedClosedShell.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <StepShape_OrientedClosedShell.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <fmt/format.h>
#include <gp_GTrsf.hxx>

#include "core/base/vec.h"

namespace core::cad {

/// A name of a file as one line of UTF-8.
std::string plain_name(std::string_view text) {
    constexpr size_t longest = 200;
    std::string line;
    for (const char c : text) {
        const bool is_printed = static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
        line += is_printed ? c : ' ';
    }
    const size_t first = std::min(line.find_first_not_of(' '), line.size());
    line = line.substr(first, line.find_last_not_of(' ') + 1 - first);
    size_t end = std::min(line.size(), longest);
    const auto is_inside_character = [&](size_t at) {
        return at < line.size() && (static_cast<unsigned char>(line[at]) & 0xc0U) == 0x80U;
    };
    while (is_inside_character(end)) --end;
    return line.substr(0, end);
}

namespace {

/// The number of an entity in its file, for a message: "#12".
std::string entity_text(const Handle(Interface_InterfaceModel) & model,
                        const Handle(Standard_Transient) & entity) {
    const Handle(TCollection_HAsciiString) label = model->StringLabel(entity);
    return label.IsNull() ? "an entity" : std::string(label->ToCString());
}

bool has_any(std::string_view text, const std::vector<std::string_view>& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](std::string_view part) {
        return text.find(part) != std::string_view::npos;
    });
}

/// Whether a body could be missing, out of shape or out of place without an entity of this type.
///
/// Files are full of entities that Open CASCADE does not understand, about dimensions, tolerances,
/// displays and persons. What only links shapes to products and to each other is none of them:
/// without it, `names_of_solids` finds that a shape was not made.
bool is_needed(std::string_view type) {
    if (type.starts_with("StepGeom_") || type.starts_with("IGESGeom_")
        || type.starts_with("IGESSolid_") || type.starts_with("IGESBasic_"))
        return true;
    if (type.starts_with("StepShape_"))
        return type != "StepShape_ShapeRepresentation"
               && type != "StepShape_ShapeDefinitionRepresentation"
               && !has_any(type, {"Dimension", "Tolerance", "Limits"});
    if (type.starts_with("StepRepr_"))
        return has_any(type, {"Transformation", "AssemblyUsage", "MappedItem", "RepresentationMap",
                              "UnitAssigned", "ProductDefinitionShape"});
    return type.starts_with("StepBasic_") && has_any(type, {"Unit", "ProductDefinition"});
}

/// "#12 is missing" of a message like "Unresolved Reference, Ent.Id.#3 Param.n0 2 (Id.#12)".
std::string missing_text(const std::string& message) {
    const size_t at = message.find("(Id.");
    const size_t end = message.find(')', at == std::string::npos ? 0 : at);
    if (at == std::string::npos || end == std::string::npos) return plain_name(message);
    return message.substr(at + 4, end - at - 4) + " is missing";
}

/// Refuses a file whose bodies are in other files.
Result<bool> check_references(const Handle(XSControl_WorkSession) & session) {
    STEPConstruct_ExternRefs references(session);
    references.LoadExternRefs();
    if (references.NbExternRefs() == 0) return true;
    const char* const file = references.FileName(1);
    return fail(ErrorCode::unsupported,
                fmt::format("it refers to other files{}: export the assembly as one file",
                            file ? fmt::format(", such as {}", plain_name(file)) : ""));
}

/// Refuses bodies of kinds that Open CASCADE does not know. Tessellated ones are usually there
/// beside exact ones, in a representation of their own.
Result<bool> check_kinds(const Handle(Interface_InterfaceModel) & model) {
    bool has_strange_items = false; // in representations for exact bodies
    for (int i = 1; i <= model->NbEntities(); ++i)
        has_strange_items |= model->IsErrorEntity(i)
                             && model->Value(i)->DynamicType()->Name()
                                    == std::string_view("StepShape_ShapeRepresentation");
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto entity = Handle(StepData_UndefinedEntity)::DownCast(model->Value(i));
        const std::string_view type = entity.IsNull() ? "" : entity->StepType();
        const bool is_body =
            type.ends_with("SOLID") || type.ends_with("BREP") || type.ends_with("SURFACE_MODEL")
            || type == "BLOCK" || type == "SPHERE" || type == "TORUS"
            || type.starts_with("RIGHT_CIRCULAR_") || type.starts_with("RIGHT_ANGULAR_");
        const std::string_view own = model->Value(i)->DynamicType()->Name();
        const bool is_primitive =
            own == "StepShape_Block" || own == "StepShape_Sphere" || own == "StepShape_Torus"
            || own.starts_with("StepShape_RightCircular")
            || own.starts_with("StepShape_RightAngular") || own == "StepShape_BooleanResult";
        if (is_primitive)
            return fail(ErrorCode::unsupported,
                        fmt::format("Open CASCADE cannot read {}, which is a body without faces "
                                    "({}): export it as a solid with faces, or as STL",
                                    entity_text(model, model->Value(i)), own.substr(10)));
        if (is_body && (has_strange_items || !type.starts_with("TESSELLATED_")))
            return fail(ErrorCode::unsupported,
                        fmt::format("Open CASCADE cannot read {}, which is a {}: export it as a "
                                    "solid with faces, or as STL",
                                    entity_text(model, entity), type));
    }
    return true;
}

Vec3 vector_of(const Handle(StepGeom_Direction) & direction) {
    Vec3 v(0.0);
    for (int i = 0; i < std::min(3, direction->NbDirectionRatios()); ++i)
        v[i] = direction->DirectionRatiosValue(i + 1);
    return v;
}

/// Whether the axes of a transformation are left-handed, or undefined. Those that are not stated
/// are those of the coordinates; all are at right angles to the ones before, third axis first.
///
/// Source: ISO 10303-42, base_axis.
bool is_mirror(const Handle(StepGeom_CartesianTransformationOperator3d) & map) {
    constexpr double rounding = 1e-6;
    const auto axis = [](bool is_stated, const Handle(StepGeom_Direction) & stated,
                         const Vec3& otherwise) {
        return is_stated ? glm::normalize(vector_of(stated)) : otherwise;
    };
    const Vec3 z = axis(map->HasAxis3(), map->Axis3(), {0.0, 0.0, 1.0});
    const bool is_along_x = std::abs(std::abs(z.x) - 1.0) < rounding;
    Vec3 x = axis(map->HasAxis1(), map->Axis1(), is_along_x ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
    x -= glm::dot(x, z) * z;
    const Vec3 y = axis(map->HasAxis2(), map->Axis2(), {0.0, 1.0, 0.0});
    const double hand = glm::dot(glm::cross(x, y), z);
    return !(hand > rounding);
}

/// Refuses transformations that Open CASCADE takes for others: scaled, mirrored, to a mere point.
Result<bool> check_transformations(const Handle(Interface_InterfaceModel) & model) {
    const auto refused = [&](const Handle(Standard_Transient) & entity) {
        return fail(ErrorCode::unsupported,
                    fmt::format("Open CASCADE cannot scale, mirror or place a part as {} says: "
                                "export the part in its final place",
                                entity_text(model, entity)));
    };
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        const auto map = Handle(StepGeom_CartesianTransformationOperator3d)::DownCast(entity);
        constexpr double rounding = 1e-9;
        if (!map.IsNull()
            && ((map->HasScale() && std::abs(map->Scale() - 1.0) > rounding) || is_mirror(map)))
            return refused(entity);
        const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
        if (!item.IsNull() && !item->MappingTarget().IsNull()
            && item->MappingTarget()->IsKind(STANDARD_TYPE(StepGeom_Point)))
            return refused(entity);
    }
    return true;
}

/// How many contexts of shapes state a unit of angles.
struct AngleUnits {
    int stated = 0, missing = 0;
};

/// Refuses coordinates without a unit.
template <typename Context>
Result<bool> check_unit(const Handle(Interface_InterfaceModel) & model,
                        const Handle(Standard_Transient) & entity, AngleUnits& angles) {
    const auto context = Handle(Context)::DownCast(entity);
    if (context.IsNull()) return true;
    STEPConstruct_UnitContext units;
    units.ComputeFactors(context->GlobalUnitAssignedContext());
    const auto stated = context->GlobalUnitAssignedContext()->Units();
    int lengths = 0;
    for (int i = 1; !stated.IsNull() && i <= stated->Length(); ++i)
        lengths +=
            stated->Value(i)->IsKind(STANDARD_TYPE(StepBasic_SiUnitAndLengthUnit))
            || stated->Value(i)->IsKind(STANDARD_TYPE(StepBasic_ConversionBasedUnitAndLengthUnit));
    if (lengths > 1)
        return fail(ErrorCode::invalid_value,
                    fmt::format("{} states several units of length: export the file again",
                                entity_text(model, entity)));
    if (!units.LengthDone()) {
        return fail(ErrorCode::invalid_value,
                    fmt::format("{} states no unit of length: export the file again",
                                entity_text(model, entity)));
    }
    ++(units.PlaneAngleDone() ? angles.stated : angles.missing);
    return true;
}

Result<bool> check_units(const Handle(Interface_InterfaceModel) & model) {
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto unit = Handle(StepBasic_SiUnitAndLengthUnit)::DownCast(model->Value(i));
        if (!unit.IsNull() && unit->Name() != StepBasic_sunMetre)
            return fail(ErrorCode::invalid_value,
                        fmt::format("{} is no unit of length: export the file again",
                                    entity_text(model, unit)));
    }
    using WithUncertainty = StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx;
    using Without = StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext;
    AngleUnits angles;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        FEELER_TRY([[maybe_unused]] const bool a,
                   check_unit<WithUncertainty>(model, model->Value(i), angles));
        FEELER_TRY([[maybe_unused]] const bool b,
                   check_unit<Without>(model, model->Value(i), angles));
    }
    // Open CASCADE takes the unit of another context.
    if (angles.stated > 0 && angles.missing > 0)
        return fail(ErrorCode::invalid_value,
                    "only some of its parts state a unit of angles: export the file again");
    return true;
}

/// What the structure of an assembly consists of.
struct Structure {
    std::vector<Handle(StepRepr_NextAssemblyUsageOccurrence)> uses;
    std::set<const Standard_Transient*> placed;      // uses whose place is stated
    std::set<const Standard_Transient*> with_bodies; // products that have a shape or parts
    // Places of another kind: how often a representation is mapped, and the representations of
    // each product. Some are only related to others that are mapped.
    std::map<const Standard_Transient*, int> mapped;
    std::map<const Standard_Transient*, std::set<const Standard_Transient*>> shapes;
    std::vector<std::pair<const Standard_Transient*, const Standard_Transient*>> related;

    /// How many places mapped items give to a product.
    int mapped_places(const Standard_Transient* product) const {
        const auto found = shapes.find(product);
        if (found == shapes.end()) return 0;
        std::set<const Standard_Transient*> own = found->second;
        for (size_t before = 0; before != own.size();) {
            before = own.size();
            for (const auto& [one, other] : related) {
                if (own.contains(one)) own.insert(other);
                if (own.contains(other)) own.insert(one);
            }
        }
        int count = 0;
        for (const Standard_Transient* shape : own)
            if (const auto times = mapped.find(shape); times != mapped.end())
                count += times->second;
        return count;
    }
};

Structure structure_of(const Handle(Interface_InterfaceModel) & model) {
    Structure found;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
        if (!item.IsNull() && !item->MappingSource().IsNull())
            ++found.mapped[item->MappingSource()->MappedRepresentation().get()];
        const auto relation = Handle(StepRepr_ShapeRepresentationRelationship)::DownCast(entity);
        if (!relation.IsNull())
            found.related.emplace_back(relation->Rep1().get(), relation->Rep2().get());
        if (const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
            !use.IsNull()) {
            found.uses.push_back(use);
            found.with_bodies.insert(use->RelatingProductDefinition().get());
        }
        const auto place = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity);
        if (!place.IsNull() && !place->RepresentedProductRelation().IsNull())
            found.placed.insert(place->RepresentedProductRelation()
                                    ->Definition()
                                    .ProductDefinitionRelationship()
                                    .get());
        const auto shape = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(entity);
        if (shape.IsNull() || shape->Definition().PropertyDefinition().IsNull()) continue;
        const auto product =
            shape->Definition().PropertyDefinition()->Definition().ProductDefinition();
        found.with_bodies.insert(product.get());
        found.shapes[product.get()].insert(shape->UsedRepresentation().get());
    }
    return found;
}

/// Refuses an assembly in which a part has no place: Open CASCADE leaves it out. Places of
/// relations that are no use in an assembly are left out as well.
Result<bool> check_places(const Handle(Interface_InterfaceModel) & model) {
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto place =
            Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(model->Value(i));
        if (place.IsNull() || place->RepresentedProductRelation().IsNull()) continue;
        const Handle(Standard_Transient) relation =
            place->RepresentedProductRelation()->Definition().ProductDefinitionRelationship();
        if (relation.IsNull()
            || relation->IsKind(STANDARD_TYPE(StepRepr_NextAssemblyUsageOccurrence)))
            continue;
        return fail(ErrorCode::unsupported,
                    fmt::format("Open CASCADE does not place a part as {} says: export the part in "
                                "its final place",
                                entity_text(model, place)));
    }
    const Structure structure = structure_of(model);
    std::map<const Standard_Transient*, int> without_place; // uses of a product
    for (const auto& use : structure.uses)
        if (!structure.placed.contains(use.get())
            && structure.with_bodies.contains(use->RelatedProductDefinition().get())
            && ++without_place[use->RelatedProductDefinition().get()]
                   > structure.mapped_places(use->RelatedProductDefinition().get()))
            return fail(ErrorCode::invalid_value,
                        fmt::format("{} puts a part into an assembly without stating its place: "
                                    "export the file again",
                                    entity_text(model, use)));
    return true;
}

size_t faces_of(const Handle(IGESSolid_Shell) & shell) {
    return shell.IsNull() ? 0 : static_cast<size_t>(shell->NbFaces());
}

size_t faces_of(const Handle(IGESSolid_ManifoldSolid) & solid) {
    size_t count = faces_of(solid->Shell());
    for (int i = 1; i <= solid->NbVoidShells(); ++i) count += faces_of(solid->VoidShell(i));
    return count;
}

size_t count_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
    size_t count = 0;
    for (TopExp_Explorer e(shape, kind); e.More(); e.Next()) ++count;
    return count;
}

bool is_surface_model(const Handle(Standard_Transient) & entity) {
    return entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel))
           || entity->IsKind(STANDARD_TYPE(StepShape_FaceBasedSurfaceModel));
}

tl::unexpected<Error> fail_to_make(const char* what, const Handle(Interface_InterfaceModel) & model,
                                   const Handle(Standard_Transient) & entity) {
    return fail(ErrorCode::invalid_value,
                fmt::format("Open CASCADE cannot make the {} {}: repair it in the CAD system, or "
                            "export the body as STL",
                            what, entity_text(model, entity)));
}

/// How many faces of a solid that was made have the outside where the file has it, and how many
/// have it on the other side.
struct Sides {
    struct Count {
        int kept = 0, turned = 0;
    };
    Count open, closed; // on planes, cylinders and cones; on all others, which may be closed
    bool has_closed = false;
};

/// A surface without the rectangles of parameters that it is cut to.
Handle(StepGeom_Surface) untrimmed(Handle(StepGeom_Surface) surface) {
    while (true) {
        const auto trimmed = Handle(StepGeom_RectangularTrimmedSurface)::DownCast(surface);
        if (trimmed.IsNull() || trimmed->BasisSurface().IsNull()) return surface;
        surface = trimmed->BasisSurface();
    }
}

void count_sides(const Handle(StepShape_ConnectedFaceSet) & shell,
                 const TopTools_DataMapOfShapeInteger& sides,
                 const Handle(Transfer_TransientProcess) & made, Sides& count) {
    if (shell.IsNull()) return;
    for (int i = 1; i <= shell->NbCfsFaces(); ++i) {
        const auto face = Handle(StepShape_FaceSurface)::DownCast(shell->CfsFacesValue(i));
        if (face.IsNull() || face->FaceGeometry().IsNull()) continue;
        const std::string_view kind = untrimmed(face->FaceGeometry())->DynamicType()->Name();
        const bool is_open = kind == "StepGeom_Plane" || kind == "StepGeom_CylindricalSurface"
                             || kind == "StepGeom_ConicalSurface";
        count.has_closed |= !is_open;
        TopoDS_Shape shape = TransferBRep::ShapeResult(made, face);
        if (shape.IsNull()) continue;
        shape.Orientation(TopAbs_FORWARD);
        shape.Location(TopLoc_Location());
        if (!sides.IsBound(shape)) continue;
        Sides::Count& one = is_open ? count.open : count.closed;
        ++((sides.Find(shape) > 0) == static_cast<bool>(face->SameSense()) ? one.kept : one.turned);
    }
}

/// The shells of a solid or of a set of surfaces that bound it from outside.
std::vector<Handle(StepShape_ConnectedFaceSet)> outer_shells(const Handle(Standard_Transient)
                                                             & entity) {
    if (const auto solid = Handle(StepShape_ManifoldSolidBrep)::DownCast(entity); !solid.IsNull())
        return {solid->Outer()};
    std::vector<Handle(StepShape_ConnectedFaceSet)> shells;
    if (const auto surfaces = Handle(StepShape_ShellBasedSurfaceModel)::DownCast(entity);
        !surfaces.IsNull())
        for (int i = 1; i <= surfaces->NbSbsmBoundary(); ++i)
            shells.push_back(Handle(StepShape_ConnectedFaceSet)::DownCast(
                surfaces->SbsmBoundaryValue(i).Value()));
    if (const auto surfaces = Handle(StepShape_FaceBasedSurfaceModel)::DownCast(entity);
        !surfaces.IsNull())
        for (int i = 1; i <= surfaces->FbsmFaces()->Length(); ++i)
            shells.push_back(surfaces->FbsmFaces()->Value(i));
    return shells;
}

/// The shells of the voids of a solid.
std::vector<Handle(StepShape_ConnectedFaceSet)> void_shells(const Handle(Standard_Transient)
                                                            & entity) {
    std::vector<Handle(StepShape_ConnectedFaceSet)> shells;
    if (const auto solid = Handle(StepShape_BrepWithVoids)::DownCast(entity);
        !solid.IsNull() && !solid->Voids().IsNull())
        for (const auto& shell : *solid->Voids())
            if (!shell.IsNull()) shells.push_back(shell->ClosedShellElement());
    return shells;
}

/// Refuses a solid of which Open CASCADE has taken the wrong side of the border of a face on a
/// sphere or a torus. It then turns this face, or the whole solid, inside out.
Result<bool> check_sides(const Handle(Interface_InterfaceModel) & model,
                         const Handle(Standard_Transient) & entity, const TopoDS_Shape& solid,
                         const Handle(Transfer_TransientProcess) & made) {
    TopTools_DataMapOfShapeInteger sides;
    for (TopExp_Explorer e(solid.Oriented(TopAbs_FORWARD), TopAbs_FACE); e.More(); e.Next()) {
        TopoDS_Shape face = e.Current();
        const int side = face.Orientation() == TopAbs_FORWARD ? 1 : -1;
        face.Orientation(TopAbs_FORWARD);
        face.Location(TopLoc_Location());
        sides.Bind(face, side);
    }
    Sides count;
    for (const auto& shell : outer_shells(entity)) count_sides(shell, sides, made, count);
    const auto& [open, closed, has_closed] = count;
    const int turned = open.turned + closed.turned;
    // A file without round faces whose faces all look inwards has another fault, which is mended.
    bool is_wrong = turned > 0 && (has_closed || open.kept > 0);
    for (const auto& shell : void_shells(entity)) {
        Sides sides_of_void; // all kept or all turned, as the shell is
        count_sides(shell, sides, made, sides_of_void);
        const auto& [flat, round, has_round] = sides_of_void;
        is_wrong |= flat.kept + round.kept > 0 && flat.turned + round.turned > 0;
    }
    if (!is_wrong) return true;
    return fail(ErrorCode::invalid_value,
                fmt::format("Open CASCADE reads a round face of the solid {} inside out, as the "
                            "part that is not there: export the body as STL",
                            entity_text(model, entity)));
}

} // namespace

Result<bool> check_entities(const Handle(Interface_InterfaceModel) & model) {
    for (int i = 1; i <= model->NbEntities(); ++i)
        if (model->IsErrorEntity(i) && is_needed(model->Value(i)->DynamicType()->Name()))
            return fail(ErrorCode::syntax,
                        fmt::format("it is damaged: {} cannot be read; export it again",
                                    entity_text(model, model->Value(i))));
    // References to entities that are not in the file are no fault of the entity that has them.
    const Handle(Interface_Check) whole = model->GlobalCheck();
    if (!whole.IsNull() && whole->HasFailed())
        return fail(ErrorCode::syntax,
                    "it is damaged: " + missing_text(whole->CFail(1)) + "; export it again");
    return true;
}

Result<bool> check_step(const Handle(XSControl_WorkSession) & session) {
    const Handle(Interface_InterfaceModel) model = session->Model();
    FEELER_TRY([[maybe_unused]] const bool whole, check_entities(model));
    FEELER_TRY([[maybe_unused]] const bool alone, check_references(session));
    FEELER_TRY([[maybe_unused]] const bool known, check_kinds(model));
    FEELER_TRY([[maybe_unused]] const bool rigid, check_transformations(model));
    FEELER_TRY([[maybe_unused]] const bool measured, check_units(model));
    return check_places(model);
}

Result<SolidNames> names_of_solids(const Handle(XSControl_WorkSession) & session) {
    const Handle(Interface_InterfaceModel) model = session->Model();
    const Handle(Transfer_TransientProcess) made = session->TransferReader()->TransientProcess();
    SolidNames names;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        if (is_surface_model(model->Value(i))) {
            const TopoDS_Shape surfaces = TransferBRep::ShapeResult(made, model->Value(i));
            if (surfaces.IsNull()) return fail_to_make("surfaces", model, model->Value(i));
            FEELER_TRY([[maybe_unused]] const bool whole,
                       check_sides(model, model->Value(i), surfaces, made));
        }
        const auto entity = Handle(StepShape_SolidModel)::DownCast(model->Value(i));
        if (entity.IsNull()) continue;
        const TopoDS_Shape solid = TransferBRep::ShapeResult(made, entity);
        if (solid.IsNull()) return fail_to_make("solid", model, entity);
        const size_t solids = count_of(solid, TopAbs_SOLID);
        if (solids != 1)
            return fail(ErrorCode::invalid_value,
                        fmt::format("Open CASCADE makes {} solids of the solid {}, which may lack "
                                    "a part: export the body as STL",
                                    solids, entity_text(model, entity)));
        if (const auto brep = Handle(StepShape_ManifoldSolidBrep)::DownCast(entity);
            !brep.IsNull()) {
            FEELER_TRY([[maybe_unused]] const bool whole, check_sides(model, brep, solid, made));
        }
        const Handle(TCollection_HAsciiString) text = entity->Name();
        const std::string name = text.IsNull() ? "" : plain_name(text->ToCString());
        if (!name.empty()) names.push_back({solid, name});
    }
    return names;
}

/// Whether a border without curves in the parameters may leave open which part of a surface is
/// meant: the surface closes on itself, or may do so.
bool is_round(const Handle(IGESData_IGESEntity) & surface) {
    if (surface.IsNull()) return true;
    constexpr int plane = 108, line = 110, revolution = 120, tabulated = 122, spline = 128;
    constexpr int plane_solid = 190, cylinder = 192, cone = 194;
    switch (surface->TypeNumber()) {
    case plane:
    case tabulated:
    case plane_solid:
    case cylinder:
    case cone:
        return false;
    case revolution: {
        const auto turned = Handle(IGESGeom_SurfaceOfRevolution)::DownCast(surface);
        return turned.IsNull() || turned->Generatrix().IsNull()
               || turned->Generatrix()->TypeNumber() != line;
    }
    case spline: {
        const auto bent = Handle(IGESGeom_BSplineSurface)::DownCast(surface);
        return bent.IsNull() || bent->IsClosedU() || bent->IsClosedV();
    }
    default:
        return true;
    }
}

/// Whether a border of a face on such a surface has no curves in the parameters.
bool lacks_parameters(const Handle(IGESGeom_CurveOnSurface) & border) {
    return border->CurveUV().IsNull() && is_round(border->Surface());
}

bool lacks_parameters(const Handle(IGESSolid_Face) & face) {
    if (!is_round(face->Surface())) return false;
    for (int i = 1; i <= face->NbLoops(); ++i) {
        const Handle(IGESSolid_Loop) loop = face->Loop(i);
        for (int k = 1; !loop.IsNull() && k <= loop->NbEdges(); ++k)
            if (loop->NbParameterCurves(k) == 0) return true;
    }
    return false;
}

Result<bool> check_parameters(const Handle(Interface_InterfaceModel) & model,
                              const Handle(Standard_Transient) & entity) {
    const auto border = Handle(IGESGeom_CurveOnSurface)::DownCast(entity);
    const auto face = Handle(IGESSolid_Face)::DownCast(entity);
    const bool lacks = (!border.IsNull() && lacks_parameters(border))
                       || (!face.IsNull() && lacks_parameters(face));
    if (!lacks) return true;
    return fail(ErrorCode::unsupported,
                fmt::format("{} bounds a part of a round surface without curves in its parameters, "
                            "and it is not certain which part: export the body with these curves, "
                            "or as STEP or STL",
                            entity_text(model, entity)));
}

/// Whether a matrix keeps lengths and angles. It may mirror: curves are often placed so.
bool keeps_shape(const gp_GTrsf& matrix) {
    constexpr double rounding = 1e-4; // files state few digits, such as .7071
    Mat3 turn;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            turn[column][row] = matrix.Value(row + 1, column + 1);
    const Mat3 square = glm::transpose(turn) * turn;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (std::abs(square[i][k] - (i == k ? 1.0 : 0.0)) > rounding) return false;
    return true;
}

/// Why Open CASCADE does not place what an IGES entity describes as the file says; empty: it does.
std::string why_misplaced(const Handle(IGESData_IGESEntity) & entity) {
    constexpr int rectangular_array = 412, circular_array = 414, external = 416, matrix = 124;
    constexpr int first_part_of_solid = 502, last_part_of_solid = 514;
    const int type = entity->TypeNumber();
    if (type == rectangular_array || type == circular_array) return "copies of a part";
    if (type == external) return "a part in another file";
    const auto part = Handle(IGESBasic_SingularSubfigure)::DownCast(entity);
    if (!part.IsNull() && part->ScaleFactor() != 1.0) return "a part that is scaled";
    const bool is_part = type >= first_part_of_solid && type <= last_part_of_solid;
    if (entity->HasTransf() && (is_part || type == matrix)) return "a place within a place";
    const auto place = Handle(IGESGeom_TransformationMatrix)::DownCast(entity);
    constexpr int left_handed = 1;
    if (!place.IsNull() && place->FormNumber() <= left_handed && !keeps_shape(place->Value()))
        return "a place that scales or shears";
    return {};
}

/// Refuses what Open CASCADE leaves out, or does not place as the file says, without an error.
Result<bool> check_copies(const Handle(Interface_InterfaceModel) & model) {
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const auto entity = Handle(IGESData_IGESEntity)::DownCast(model->Value(i));
        const std::string why = entity.IsNull() ? "" : why_misplaced(entity);
        if (why.empty()) continue;
        return fail(ErrorCode::unsupported,
                    fmt::format("Open CASCADE leaves out {}, {} (IGES type {}): export each body "
                                "in its place, in one file",
                                entity_text(model, entity), why, entity->TypeNumber()));
    }
    return true;
}

/// The unit as it is stated by a number, or by a name that Open CASCADE knows.
bool states_unit(const IGESData_GlobalSection& global) {
    constexpr int by_name = 3;
    if (global.UnitFlag() < 1 || global.UnitFlag() > 11) return false;
    if (global.UnitFlag() != by_name) return true;
    static const std::set<std::string> known = {"IN", "INCH", "MM",  "mm", "FT", "MI",
                                                "M",  "KM",   "MIL", "UM", "CM", "UIN"};
    return !global.UnitName().IsNull() && known.contains(global.UnitName()->ToCString());
}

Result<bool> check_transferred_iges(const Handle(XSControl_WorkSession) & session) {
    const Handle(Interface_InterfaceModel) model = session->Model();
    const auto& global = Handle(IGESData_IGESModel)::DownCast(model)->GlobalSection();
    if (global.Scale() != 1.0)
        return fail(ErrorCode::unsupported,
                    fmt::format("its model space has the scale {:g}: export it at full size",
                                global.Scale()));
    if (!states_unit(global))
        return fail(ErrorCode::invalid_value,
                    "it states no unit of length, or one that is not known: export it again");
    FEELER_TRY([[maybe_unused]] const bool alone, check_copies(model));
    const Handle(Transfer_TransientProcess) made = session->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        const auto solid = Handle(IGESSolid_ManifoldSolid)::DownCast(entity);
        const auto any = Handle(IGESData_IGESEntity)::DownCast(entity);
        const int type = any.IsNull() ? 0 : any->TypeNumber();
        FEELER_TRY([[maybe_unused]] const bool certain, check_parameters(model, entity));
        constexpr int first_solid = 150, last_solid = 184, manifold = 186, instance = 430;
        const bool is_primitive = (type >= first_solid && type <= last_solid) || type == instance;
        if (is_primitive && TransferBRep::ShapeResult(made, entity).IsNull())
            return fail(ErrorCode::unsupported,
                        fmt::format("Open CASCADE cannot read {}, a solid without faces (IGES type "
                                    "{}): export it as a solid with faces, or as STL",
                                    entity_text(model, entity), type));
        if (type == manifold && any->HasTransf())
            return fail(ErrorCode::unsupported,
                        fmt::format("Open CASCADE does not move {} to its place: export the part "
                                    "in its final place, or as STEP",
                                    entity_text(model, entity)));
        const bool is_surface = entity->IsKind(STANDARD_TYPE(IGESGeom_TrimmedSurface))
                                || entity->IsKind(STANDARD_TYPE(IGESGeom_BoundedSurface));
        if (solid.IsNull() && !is_surface) continue;
        const TopoDS_Shape shape = TransferBRep::ShapeResult(made, entity);
        if (shape.IsNull()) return fail_to_make(is_surface ? "surface" : "solid", model, entity);
        if (!solid.IsNull() && count_of(shape, TopAbs_FACE) < faces_of(solid))
            return fail_to_make("faces of the solid", model, entity);
    }
    return true;
}

} // namespace core::cad
