// SPDX-License-Identifier: MIT
// Checks that a camera's images are of one kind, and decodes them one by one.
#include "replay/image_sequence.hpp"

#include "replay/image_error.hpp"
#include "replay/natural_order.hpp"

namespace rptv {
namespace {

std::string size_text(const ImageShape& shape) {
  return std::to_string(shape.width_px) + " x " + std::to_string(shape.height_px) + " pixels";
}

void check_same_kind(const std::filesystem::path& file, const ImageShape& shape, const std::filesystem::path& first,
                     const ImageShape& expected) {
  constexpr std::string_view kStep =
      "the images of a camera are of one kind: convert it or leave it out with "
      "replay.pattern";
  if (!shape.has_size_of(expected))
    throw image_error(
        file, "is " + size_text(shape) + ", but " + first.filename().string() + " is " + size_text(expected), kStep);
  if (shape.bytes_per_pixel != expected.bytes_per_pixel)
    throw image_error(file,
                      "has " + std::to_string(shape.bytes_per_pixel * 8) + " bits per pixel, but " +
                          first.filename().string() + " has " + std::to_string(expected.bytes_per_pixel * 8),
                      kStep);
}

}  // namespace

ImageSequence::ImageSequence(std::string camera, std::vector<std::filesystem::path> files)
    : camera_(std::move(camera)), files_(std::move(files)) {
  for (std::size_t file = 0; file < files_.size(); ++file) add(file);
  number_by_name();
}

void ImageSequence::add(std::size_t file) {
  const auto reader = open_image(files_[file]);
  if (files_.size() > 1 && reader->pages() > 1)
    throw image_error(files_[file], "holds " + std::to_string(reader->pages()) + " images beside other files",
                      "give the multi-page file itself as replay.path, or keep one image per file");
  if (images_.empty()) header_ = reader->header(0);
  for (std::size_t page = 0; page < reader->pages(); ++page) {
    check_same_kind(files_[file], reader->header(page).shape, files_[0], header_.shape);
    header_.significant_bits = std::max(header_.significant_bits, reader->header(page).significant_bits);
    images_.push_back({file, page, images_.size()});
  }
}

void ImageSequence::number_by_name() {
  numbered_ = true;
  if (files_.size() == 1) return;  // pages, or a single image: the position is the number
  std::string around;
  for (std::size_t i = 0; i < images_.size() && numbered_; ++i) {
    const auto name = last_number(file(i).stem().string());
    numbered_ = name && (i == 0 || (name->around == around && name->number > images_[i - 1].number));
    if (!numbered_) break;
    around = name->around;
    images_[i].number = name->number;
  }
  if (!numbered_) number_by_position();
}

void ImageSequence::number_by_position() noexcept {
  numbered_ = false;
  for (std::size_t i = 0; i < images_.size(); ++i) images_[i].number = i;
}

void ImageSequence::Reader::decode(std::size_t i, std::span<std::byte> pixels) {
  const Image& image = sequence_->images_[i];
  if (open_ == nullptr || open_file_ != image.file) {
    open_.reset();
    open_ = open_image(sequence_->files_[image.file]);
    open_file_ = image.file;
  }
  const bool same = image.page < open_->pages() && open_->header(image.page).shape == sequence_->header_.shape;
  if (!same) throw image_error(sequence_->files_[image.file], "has changed since the start", kCopyAgain);
  open_->decode(image.page, pixels);
  if (open_->pages() == 1) open_.reset();
}

}  // namespace rptv
