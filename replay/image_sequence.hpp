// SPDX-License-Identifier: MIT
// A camera's images in order, found in a folder or in one multi-page TIFF and checked before anything runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "replay/image_file.hpp"

namespace rptv {

/// Immutable after construction: any number of threads may read it, each through its own Reader.
class ImageSequence {
 public:
  /// One image per file in the order given, or a single TIFF with an image per page. Opens every file and checks every
  /// header; throws Error naming the first file that is missing, empty, damaged, of another size or of another depth.
  ImageSequence(std::string camera, std::vector<std::filesystem::path> files);

  const std::string& camera() const noexcept { return camera_; }
  std::size_t size() const noexcept { return images_.size(); }
  const ImageShape& shape() const noexcept { return header_.shape; }
  std::uint32_t significant_bits() const noexcept { return header_.significant_bits; }

  /// Frame number of image i, strictly rising: the last number in the file's name when the names differ in nothing
  /// else, the page of a TIFF; else (numbered() is false) simply i.
  std::uint64_t number(std::size_t i) const noexcept { return images_[i].number; }
  bool numbered() const noexcept { return numbered_; }
  void number_by_position() noexcept;
  const std::filesystem::path& file(std::size_t i) const noexcept { return files_[images_[i].file]; }

  /// Decodes images of one sequence; keeps a multi-page file open. One thread; the sequence must outlive it.
  class Reader {
   public:
    explicit Reader(const ImageSequence& sequence) : sequence_(&sequence) {}
    /// Fills `pixels` (shape().bytes() long). Throws Error when the file has vanished, changed or is damaged.
    void decode(std::size_t i, std::span<std::byte> pixels);

   private:
    const ImageSequence* sequence_;
    std::unique_ptr<ImageReader> open_;
    std::size_t open_file_ = 0;
  };

 private:
  struct Image {
    std::size_t file = 0;
    std::size_t page = 0;
    std::uint64_t number = 0;
  };
  void add(std::size_t file);
  void number_by_name();

  std::string camera_;
  std::vector<std::filesystem::path> files_;
  std::vector<Image> images_;
  ImageHeader header_;
  bool numbered_ = false;
};

/// Finds the cameras under `path`, 1 to kMaxCameras, in order of their numbers:
///   - a file: one camera, its pages (TIFF) or its single image;
///   - a folder with sub-folders cam0, cam1, …: one camera each;
///   - a folder with files cam0.tif, cam1.tif, …: one camera each, an image per page;
///   - a folder with files cam0_…, cam1_…: one camera per prefix;
///   - any other folder: one camera, cam0.
/// Within a folder `pattern` (a glob such as "frame_*.png") picks the images by name. An empty pattern takes frame_* if
/// there are any, else cam<number>_*, else every PNG and TIFF but dark*, white* and background*. Images are sorted by
/// the numbers in their names. Throws Error(no_input, bad_data, permission, configuration) naming the file.
std::vector<ImageSequence> open_cameras(const std::filesystem::path& path, const std::string& pattern = "");

}  // namespace rptv
