#pragma once

#include <string>

namespace test_support {

/// The tool of the worked example: flutes 20 mm long, a shank of the same diameter up to 45, a 40
/// mm holder up to the gauge line at 95.
inline const std::string flat_10 = "number = 1\nshape = \"flat\"\ndiameter = 10\n"
                                   "flute_length = 20\nshank = [[10, 10, 25]]\n"
                                   "holder = [[40, 40, 50]]\n";

/// Writes a set-up piece by piece. The default is the worked example without its clamp: a stock
/// from 0, 0, -30 to 100, 100, 0, the tool flat_10, a mill with limits on all axes.
class SetupWriter {
public:
    SetupWriter& root(const std::string& keys) { return replace(root_, keys); }
    SetupWriter& program(const std::string& keys) { return replace(program_, keys); }
    SetupWriter& machine(const std::string& keys) { return replace(machine_, keys); }
    SetupWriter& stock(const std::string& keys) { return replace(stock_, keys); }
    SetupWriter& offsets(const std::string& keys) { return replace(offsets_, keys); }
    SetupWriter& lengths(const std::string& tables) { return replace(lengths_, tables); }
    SetupWriter& tool(const std::string& keys) { return replace(tools_, "[[tool]]\n" + keys); }
    SetupWriter& also(const std::string& tables) {
        also_ += tables + "\n";
        return *this;
    }
    SetupWriter& also_tool(const std::string& keys) { return also("[[tool]]\n" + keys); }

    /// `shape` is the line with its shape and all other keys it needs.
    SetupWriter& fixture(const std::string& name, const std::string& shape) {
        return also("[[fixture]]\nname = \"" + name + "\"\n" + shape);
    }
    SetupWriter& without_stock() {
        has_stock_ = false;
        return *this;
    }
    SetupWriter& without_machine() {
        has_machine_ = false;
        return *this;
    }

    std::string text() const {
        return root_ + "\n[program]\n" + program_ + (has_machine_ ? "\n[machine]\n" + machine_ : "")
               + (has_stock_ ? "\n[stock]\n" + stock_ : "") + "\n[offsets]\n" + offsets_ + "\n"
               + lengths_ + "\n" + tools_ + "\n" + also_;
    }

    static std::string axis(const std::string& name, const std::string& keys) {
        return "[[machine.axis]]\nname = \"" + name + "\"\n" + keys;
    }

    /// Three axes with the limits of the example; X and Y run at 20000 mm/min, Z at 15000.
    static std::string mill() {
        return axis("X", "direction = [1, 0, 0]\nmin = -700\nmax = 0\nrapid = 20000\n")
               + axis("Y", "direction = [0, 1, 0]\nmin = -450\nmax = 0\nrapid = 20000\n")
               + axis("Z", "direction = [0, 0, 1]\nmin = -500\nmax = 0\nrapid = 15000\n");
    }

private:
    SetupWriter& replace(std::string& piece, const std::string& with) {
        piece = with + "\n";
        return *this;
    }

    std::string root_ = "mesh_size = 0.5\n";
    std::string program_ = "dialect = \"fanuc\"\nstart = { X = -350, Y = -200, Z = 0 }\n"
                           "no_decimal_point = \"units\"\n";
    std::string machine_ = mill();
    std::string stock_ = "box = [[0, 0, -30], [100, 100, 0]]\n";
    std::string offsets_ = "G54 = { X = -350, Y = -200, Z = -420 }\n";
    std::string lengths_ = "[[length_offset]]\nnumber = 1\nlength = 95.0\n";
    std::string tools_ = "[[tool]]\n" + flat_10;
    std::string also_;
    bool has_stock_ = true, has_machine_ = true;
};

} // namespace test_support
