// Measures the motion blur of a picture, or of a region of it, and prints every field of the record: C++17. Built with
// OpenCV it reads what cv::imread reads, else PGM, PPM and PFM.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include <motion_blur.hpp>

#ifdef WITH_OPENCV
#include <motion_blur_opencv.hpp>
#include <opencv2/imgcodecs.hpp>
#else
#include "../c/pnm.h"
#endif

namespace {

#ifdef WITH_OPENCV

// A picture and what holds its samples.
struct source {
    cv::Mat matrix;
    mb_picture picture;

    source(const char *path, const char *const *region) : matrix(cv::imread(path, cv::IMREAD_UNCHANGED)), picture()
    {
        if (matrix.empty()) throw std::runtime_error(std::string(path) + " cannot be read");
        if (region != nullptr) {
            // Shares the memory of the whole: its rows are as far apart as those.
            matrix = matrix(cv::Rect(std::atoi(region[0]), std::atoi(region[1]), std::atoi(region[2]), std::atoi(region[3])));
        }
        picture = motion_blur::picture_of(matrix);
    }
};

#else

struct source {
    mb_picture picture{};
    std::unique_ptr<void, decltype(&std::free)> samples{nullptr, &std::free};

    source(const char *path, const char *const *region)
    {
        const char *wrong = pnm_read(path, &picture);
        if (wrong != nullptr) throw std::runtime_error(std::string(path) + ' ' + wrong);
        samples.reset(const_cast<void *>(picture.data));
        if (region != nullptr && !pnm_region(&picture, region)) {
            throw std::runtime_error("the region is not inside the picture");
        }
    }
};

#endif

void print(const char *name, const std::optional<double> &value)
{
    // 17 digits tell a double from every other.
    if (value) std::cout << name << '=' << std::setprecision(17) << *value << '\n';
}

void print(const std::string &method, const motion_blur::record &record)
{
    std::cout << "width=" << record.width << "\nheight=" << record.height << "\nmethod=" << method
              << "\nlinearized=" << record.linearized << "\ntracked=" << record.tracked << '\n';
    print("angle_deg", record.angle_deg);
    print("angle_std_deg", record.angle_std_deg);
    print("direction_deg", record.direction_deg);
    print("length_px", record.length_px);
    print("length_std_px", record.length_std_px);
    print("correlation", record.correlation);
    std::cout << "status=" << mb_status_name(record.status) << '\n';
    if (!record.reason.empty()) std::cout << "reason=" << record.reason << '\n';
    print("accel_ratio", record.accel_ratio);
    print("accel_ratio_std", record.accel_ratio_std);
    print("accel_ratio_limit", record.accel_ratio_limit);
    if (record.accel_detected) std::cout << "accel_detected=" << *record.accel_detected << '\n';
    print("accel_m_s2", record.accel_m_s2);
    print("accel_std_m_s2", record.accel_std_m_s2);
    print("gain_per_bin", record.gain_per_bin);
    print("rival_share", record.rival_share);
    print("incoherent_share", record.incoherent_share);
    print("misfit", record.misfit);
    print("band_cycles_per_px", record.band_cycles_per_px);
    print("exposure_s", record.exposure_s);
    print("scale_m_per_px", record.scale_m_per_px);
    print("scale_std_m_per_px", record.scale_std_m_per_px);
    print("speed_m_s", record.speed_m_s);
    print("speed_std_m_s", record.speed_std_m_s);
    print("speed_expanded_m_s", record.speed_expanded_m_s);
    print("coverage_k", record.coverage_k);
    print("angular_rate_rad_s", record.angular_rate_rad_s);
    print("angular_rate_std_rad_s", record.angular_rate_std_rad_s);
}

} // namespace

int main(int count, char **arguments)
{
    if (count != 2 && count != 6) {
        std::cerr << "usage: " << arguments[0] << " PICTURE [X Y WIDTH HEIGHT]\n";
        return 2;
    }
    try {
        const source source(arguments[1], count == 6 ? arguments + 2 : nullptr);
        // Exposure and scale make the length a speed, and the ratio of the acceleration an acceleration.
        motion_blur::configuration configuration;
        configuration.acceleration = 1;
        configuration.exposure_s = 0.1;
        configuration.exposure_std_s = 1e-4;
        configuration.geometry = MB_GEOMETRY_SCALE;
        configuration.scale_m_per_px = 7.789e-4;
        configuration.scale_std_m_per_px = 2e-6;
        motion_blur::meter meter(configuration);
        print(meter.method(), meter.measure(source.picture));
        return 0;
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
