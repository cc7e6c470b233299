#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// How far the mesh of a CAD file may be from its surface unless something else is wanted, mm.
inline constexpr double default_cad_deviation = 0.01;

/// The deviations that can be wanted, mm.
inline constexpr double least_cad_deviation = 1e-4, largest_cad_deviation = 10.0;

/// A solid of a CAD file.
struct CadSolid {
    /// Its name, after those of the assemblies that contain it, the outermost first. Each solid has
    /// a last name that no other has.
    std::vector<std::string> names;
    std::optional<Colour> colour;
    Mesh mesh; // closed and facing outwards (checked_solid), in the frame of the whole file, in mm
    /// No point of the surface of the solid is farther from the mesh, and no point of the mesh
    /// farther from that surface, mm. So for any body outside both, the distances to the solid and
    /// to the mesh differ by at most this amount (core/cad/README.md has the proof).
    double deviation = 0.0;
    double gap = 0.0;      // the part of it that is due to gaps between faces of the file, mm
    bool is_proven = true; // false: for part of the surface the deviation is measured, and doubled

    const std::string& name() const { return names.back(); }
};

/// What could be part of a body and is not read: surfaces that enclose no solid, or of a FreeCAD
/// document, what else is no solid that can be meshed.
struct CadSurfaces {
    std::vector<std::string> names; // of the part, after those of the assemblies that contain it
    std::string what;               // a sentence: "jaw has 5 surfaces that enclose no solid"
};

/// The solids of a CAD file, in its order.
struct CadFile {
    std::vector<CadSolid> solids;
    std::vector<std::string> notes;    // what was repaired, and curves that were left out
    std::vector<CadSurfaces> left_out; // what could be part of a body
    // The solids are a body together only if they have a name in common: a FreeCAD document has the
    // stock, the part and the bodies of which the part is made.
    bool bodies_are_apart = false;
};

/// The reader of CAD files that this program has, such as "Open CASCADE 7.6.3"; empty if it was
/// built without one.
std::string_view cad_library();

/// Whether the program is there that reads CAD files for this one.
bool has_cad_reader();

/// Whether the extension of a path is that of a CAD file: .step .stp .p21 .iges .igs .brep .brp
/// .FCStd
bool is_cad_file(const std::filesystem::path& path);

/// Reads the solids of a CAD file (`is_cad_file`) with Open CASCADE: STEP, IGES, shapes of Open
/// CASCADE (BREP), documents of FreeCAD.
///
/// Units:   STEP and IGES state their own, the others are in mm; the result is in mm.
/// Result:  all solids, each meshed within `deviation` (mm) of its surface. Where the file itself
///          has larger gaps between its faces, `CadSolid::deviation` is larger. The last files are
///          kept, so reading one of them again costs no more than comparing its bytes.
/// Errors:  of the file: built without Open CASCADE, damaged, without solids, an open surface, a
///          face that cannot be meshed, stopped by a `CadReadObserver`. A file is never read in
///          part, except that curves, and open surfaces beside solids, are left out and named;
///          so is what cannot be read of a FreeCAD document.
/// Cost:    about what Open CASCADE itself takes to read and mesh the file. It runs in a process of
///          its own, because damaged files can make it crash.
Result<std::shared_ptr<const CadFile>> read_cad(const std::filesystem::path& path,
                                                double deviation = default_cad_deviation);

/// What a user of its bodies should know: repairs, and what was left out.
std::vector<std::string> remarks_on(const CadFile& file);

/// A name of solids of a CAD file, and their colour if they have one.
struct CadName {
    std::string name;
    std::optional<Colour> colour; // of a solid that has it as its own name
};

/// The names by which `body_of` finds solids, each once: assemblies before what is in them.
std::vector<CadName> names_of(const CadFile& file);

/// The names in the CAD files that a set-up names, by the path as it is written there.
struct CadNames {
    std::map<std::string, std::vector<CadName>> by_file;
};

/// Those solids of a file that have this name, or are in an assembly of this name, as one mesh;
/// with an empty name, all. A mesh of several solids may overlap itself (checked_solid).
///
/// Errors:  no solid has the name, or there is no name and the bodies are apart; the message lists
///          the names there are. The file or the named assembly also has what is not read, which
///          would be missing from the body; it is left out only if the name is a solid's
///          own, and the bodies are not apart.
struct CadBody {
    Mesh mesh;
    double deviation = 0.0; // the greatest of its solids, mm
    double gap = 0.0;
    bool is_proven = true;
    size_t solids = 0;
};
Result<CadBody> body_of(const CadFile& file, const std::string& name);

/// What the reader of a CAD file is doing: a file, a step, and which part of it is done.
struct CadProgress {
    std::string file, step;
    double fraction = 0.0;
};

/// Is told the progress of read_cad on this thread while the object exists, several times a second.
/// Reading stops with an error as soon as the callback returns false.
class CadReadObserver {
public:
    using Callback = std::function<bool(const CadProgress&)>;

    explicit CadReadObserver(Callback callback);
    ~CadReadObserver();
    CadReadObserver(const CadReadObserver&) = delete;
    CadReadObserver& operator=(const CadReadObserver&) = delete;

    static const CadReadObserver* current();
    bool goes_on(const CadProgress& progress) const { return callback_(progress); }

private:
    Callback callback_;
    const CadReadObserver* older_;
};

/// Sets where the program is that reads CAD files, instead of beside this one: for tests.
void set_cad_reader(const std::filesystem::path& program);

} // namespace core
