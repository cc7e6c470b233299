#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"
#include "core/dbm/solid.h"

namespace app {

/// A CAM job of FreeCAD, as far as a set-up can use it.
struct FreeCadJob {
    std::string name;                            // its label
    std::string post_processor;                  // the name of the script; may be empty
    std::vector<std::string> work_offsets;       // "G54" ...
    std::map<core::ToolNumber, FoundTool> tools; // of its tool controllers
    std::optional<core::Solid> stock;            // a box or a cylinder, in program coordinates, mm
    std::string stock_body;         // otherwise its name in the document, where it has a shape
    bool stock_is_its_box = false;  // it is the box of that shape, along the axes
    std::string part_body;          // the name of the part in the document; empty: there is none
    std::vector<std::string> notes; // what was not taken over, and the way out
};

/// Reads the first job of a document (.FCStd): its tools, its stock and part, work offsets and post
/// processor. The shapes of stock and part are those of bodies that core::read_cad reads.
///
/// Source: documents of FreeCAD 0.20 with jobs that its Path module made (PathJob.py, PathStock.py,
///         PathToolBit.py); positions of a job are those of the document.
/// Errors: those of the archive; syntax, with line and column, for damaged XML; syntax if the
///         document has no job.
core::Result<FreeCadJob> read_freecad_job(const std::string& path);

} // namespace app
