#pragma once

#include <string>
#include <vector>

#include "core/base/vec.h"

namespace core {
struct Setup;
}

namespace app {

/// The zero of a work offset in the frame of the stock.
struct NamedZero {
    std::string name;
    core::Transform stock_from_zero = {};
};

/// A picture of a set-up with words on it.
struct SheetPicture {
    struct Label {
        std::string words;
        double x = 0.0, y = 0.0; // parts of the width and height, from the upper left
        bool is_axis = false;    // a letter at the end of an arrow; else the name of a zero
    };

    std::string jpeg; // bytes
    std::vector<Label> labels;
};

/// The pictures of a set-up sheet.
struct SheetPictures {
    SheetPicture iso, top;
    std::string missing; // why there are none; else empty
};

/// The raw stock and the fixtures at the start of the program, with arrows at the zeros. Machine
/// bodies are left out. Without OpenGL 3.3, `missing` says so.
///
/// Cost: about 0.2 s per picture.
SheetPictures sheet_pictures(const core::Setup& setup, const std::vector<NamedZero>& zeros);

} // namespace app
