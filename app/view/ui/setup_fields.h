#pragma once

#include <optional>
#include <string>

#include "app/view/ui/panel.h"
#include "core/base/vec.h"

namespace app {
enum class SetupSource : uint8_t;
} // namespace app

namespace app::viewer {

/// The fields of the set-up. A change takes effect when its field is left.
class SetupFields {
public:
    static constexpr double field_width = 74.0;

    /// Before the fields of a frame: leaves the active one if the window needs what is typed, and
    /// forgets it if the text of the set-up was replaced, as by undo.
    void begin(Frame& frame);
    /// After them.
    void end(Frame& frame);

    /// A field for a number or a length, empty with a hint if there is none yet. What was typed, if
    /// it is another number; what cannot be understood is refused in the model. Lengths are mm, and
    /// are shown and typed in the unit of the window.
    std::optional<double> number(Frame& frame, const char* id, std::optional<double> value,
                                 double width = field_width, const char* hint = "");
    std::optional<double> length(Frame& frame, const char* id, std::optional<double> mm,
                                 double width = field_width, const char* hint = "");
    /// As length(), of something that has one: refuses 0 and less.
    std::optional<double> size(Frame& frame, const char* id, double mm);
    /// Three lengths or angles in a row.
    std::optional<core::Vec3> point(Frame& frame, const char* id, const core::Vec3& mm);
    std::optional<core::Vec3> sizes(Frame& frame, const char* id, const core::Vec3& mm);
    std::optional<core::Vec3> angles(Frame& frame, const char* id, const core::Vec3& degrees);
    std::optional<std::string> words(Frame& frame, const char* id, const std::string& value,
                                     const char* hint, double width, bool is_number = false);

private:
    /// What is typed into a field and has not taken effect yet.
    struct Typed {
        ImGuiID id = 0;
        std::string words;
    };
    template <typename Field>
    std::optional<core::Vec3> three(const char* id, const core::Vec3& values, const Frame& frame,
                                    const Field& field);
    std::optional<double> refuse(Frame& frame, const std::string& why);

    std::optional<Typed> typed_;
    uint64_t replacements_ = 0; // of the text, seen so far
};

/// Draws the label of a row; its field follows on the same line.
void field_name(Frame& frame, const std::string& name);
/// "Jaw height" for the key "jaw_height".
std::string label_of(std::string_view key);

/// Draws a dot for what is stated, and a ring for what is not.
void draw_mark(const Frame& frame, ImDrawList& list, ImVec2 middle, SetupSource source);

/// The mark of a value, as an item on the same line.
void source_mark(Frame& frame, SetupSource source);

/// A unit behind a field.
void unit_label(Frame& frame, const char* unit);

} // namespace app::viewer
