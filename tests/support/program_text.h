#pragma once

#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace test_support {

/// Writes a random program; the same seed gives the same text.
class ProgramText {
public:
    explicit ProgramText(uint32_t seed) : random_(seed) {}

    int whole(int lowest, int highest) {
        return lowest + static_cast<int>(random_() % static_cast<uint32_t>(highest - lowest + 1));
    }
    /// True with a probability of 1 / `times`.
    bool once_in(int times) { return whole(1, times) == 1; }

    template <typename T>
    T one_of(std::initializer_list<T> choices) {
        return choices.begin()[whole(0, static_cast<int>(choices.size()) - 1)];
    }
    std::string one_of(std::initializer_list<const char*> choices) {
        return choices.begin()[whole(0, static_cast<int>(choices.size()) - 1)];
    }

    double length(int limit = 40) { return whole(-1000 * limit, 1000 * limit) / 1000.0; }
    double positive(int limit = 20) { return whole(1, 1000 * limit) / 1000.0; }

    /// Words of some of the axes, at least one.
    std::string axis_words(const std::string& letters, int limit = 40) {
        const int sure = whole(0, static_cast<int>(letters.size()) - 1);
        std::string words;
        for (int i = 0; i < static_cast<int>(letters.size()); ++i)
            if (i == sure || once_in(2))
                words += fmt::format(" {}{}", letters[static_cast<size_t>(i)], length(limit));
        return words;
    }

    template <typename... Values>
    void line(fmt::format_string<Values...> format, Values&&... values) {
        text_ += fmt::format(format, std::forward<Values>(values)...) + "\n";
    }

    /// A straight move, which makes every earlier change visible.
    void move(const std::string& letters = "XYZ") {
        line("{}{}", one_of({"G0", "G1", "G1", ""}), axis_words(letters));
    }

    /// A label number not used before in this program.
    int label() { return ++labels_; }

    const std::string& text() const { return text_; }

private:
    std::mt19937 random_;
    std::string text_;
    int labels_ = 0;
};

} // namespace test_support
