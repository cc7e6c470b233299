#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "render/image.h"

namespace app {

constexpr int frames_per_second = 25;

/// Pictures in order that become a film by ffmpeg, or else numbered pictures: `name-0001.png` and
/// so on. They are numbered when the output is a .png, or there is no ffmpeg.
class FilmWriter {
public:
    /// Errors: ffmpeg is there, but cannot write such a file; no room for the pictures.
    static core::Result<std::unique_ptr<FilmWriter>> open(const std::string& output);
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;
    ~FilmWriter();

    /// Errors: the picture cannot be written.
    core::Result<void> add(const render::Image& image);

    /// Makes the film; what was there under its name before stays until it is whole. The names of
    /// the pictures, where they are the result; empty for a film.
    ///
    /// Errors: ffmpeg could not write it.
    core::Result<std::string> finish();

private:
    explicit FilmWriter(const std::string& output) : output_(output) {}
    core::Error refusal() const;
    /// Where ffmpeg writes, with the extension that it knows the format by.
    std::string unfinished() const;
    std::string picture(size_t number) const;

    std::filesystem::path output_;
    std::filesystem::path folder_; // of a film's pictures; empty when they are the result
    size_t count_ = 0;
};

} // namespace app
