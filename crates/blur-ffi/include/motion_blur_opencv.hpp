// Pictures of OpenCV for motion_blur.hpp, without a copy.

#ifndef MOTION_BLUR_OPENCV_HPP
#define MOTION_BLUR_OPENCV_HPP

#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>

#include "motion_blur.h"

namespace motion_blur {

// The picture in a matrix, or in a region of one: grey, BGR or BGRA of 8 or 16 bit or float. It must live as long as the
// picture. Throws std::invalid_argument for any other matrix.
inline mb_picture picture_of(const cv::Mat &matrix)
{
    mb_picture picture{};
    picture.struct_size = sizeof picture;
    switch (matrix.depth()) {
    case CV_8U: picture.sample = MB_SAMPLE_U8; break;
    case CV_16U: picture.sample = MB_SAMPLE_U16; break;
    case CV_32F: picture.sample = MB_SAMPLE_F32; break;
    default: throw std::invalid_argument("the matrix has samples of " + cv::typeToString(matrix.type()) + ", not of 8U, 16U or 32F");
    }
    switch (matrix.channels()) {
    case 1: picture.channels = MB_CHANNELS_GREY; break;
    case 3: picture.channels = MB_CHANNELS_BGR; break;
    case 4: picture.channels = MB_CHANNELS_BGRA; break;
    default: throw std::invalid_argument("the matrix has " + std::to_string(matrix.channels()) + " channels, not 1, 3 or 4");
    }
    if (matrix.dims != 2) throw std::invalid_argument("the matrix has " + std::to_string(matrix.dims) + " dimensions, not 2");
    picture.data = matrix.data;
    picture.width = static_cast<std::size_t>(matrix.cols);
    picture.height = static_cast<std::size_t>(matrix.rows);
    picture.row_bytes = static_cast<std::ptrdiff_t>(matrix.step[0]);
    return picture;
}

} // namespace motion_blur

#endif
