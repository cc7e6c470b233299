#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/cad/cad_file.h"

namespace core::cad {

// What the program that reads CAD files is told, and what it writes to its standard output.

enum class CadFormat : uint8_t { step, iges, brep, freecad };
inline constexpr std::array all_cad_formats{CadFormat::step, CadFormat::iges, CadFormat::brep,
                                            CadFormat::freecad};

/// "step" ...: the word for a format in the arguments of the program.
std::string_view name_of(CadFormat format);

enum class MessageKind : uint8_t { progress = 1, note, left_out, error, solid, end };

/// A message in the output.
struct Message {
    MessageKind kind = MessageKind::end;
    std::string_view text; // its contents
};

std::string progress_message(std::string_view step, double fraction);
std::string text_message(MessageKind kind, std::string_view text);
std::string solid_message(const CadSolid& solid);
std::string left_out_message(const CadSurfaces& surfaces);
std::string end_message();

/// The first message of the output; empty if it is not complete yet. Takes it off.
std::optional<Message> take_message(std::string_view& output);

/// The contents of messages; empty for bytes that are no such contents.
std::optional<CadProgress> progress_of(std::string_view text);
std::optional<CadSolid> solid_of(std::string_view text);
std::optional<CadSurfaces> left_out_of(std::string_view text);

} // namespace core::cad
