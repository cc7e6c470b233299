#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Interface_InterfaceModel.hxx>
#include <TopoDS_Shape.hxx>
#include <XSControl_WorkSession.hxx>

#include "core/base/result.h"

namespace core::cad {

// Open CASCADE reads what it can of a file and leaves out the rest without an error. These find
// what a body, its shape or its place could lack.

/// A name of a file as one line of UTF-8.
std::string plain_name(std::string_view text);

/// The name of a solid itself, not of the part that consists of it.
struct SolidName {
    TopoDS_Shape solid;
    std::string name;
};
using SolidNames = std::vector<SolidName>;

/// Refuses a file with an entity that could not be read and may be needed.
Result<bool> check_entities(const Handle(Interface_InterfaceModel) & model);

/// Checks a STEP file before its shapes are made.
///
/// Errors: as check_entities; bodies in other files, or of unknown kinds; scaled parts; no unit of
///         length; a part without its place in the assembly.
Result<bool> check_step(const Handle(XSControl_WorkSession) & session);

/// The names of the solids of a STEP file whose shapes were made; errors if one was not.
Result<SolidNames> names_of_solids(const Handle(XSControl_WorkSession) & session);

/// Errors if a solid or a surface of an IGES file was not made, or a solid without some of its
/// faces; also for a scale, and without a unit.
Result<bool> check_transferred_iges(const Handle(XSControl_WorkSession) & session);

} // namespace core::cad
