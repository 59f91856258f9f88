// Motion blur measured from C++17: motion_blur.h with objects that free themselves, exceptions, and std::optional for what
// was not computed.
//
//     motion_blur::meter meter;
//     const motion_blur::record record = meter.measure(picture);
//     if (record.status == MB_STATUS_OK) std::cout << record.angle_deg << ' ' << record.length_px << '\n';
//
// Pictures are the mb_picture of motion_blur.h; motion_blur_opencv.hpp makes them of cv::Mat.

#ifndef MOTION_BLUR_HPP
#define MOTION_BLUR_HPP

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "motion_blur.h"

namespace motion_blur {

// What a call answers that fails: what() says why, with the offending numbers.
class error : public std::runtime_error {
public:
    explicit error(mb_code code) : std::runtime_error(mb_error_message()), code_(code) {}
    mb_code code() const noexcept { return code_; }

private:
    mb_code code_;
};

inline void check(mb_code code)
{
    if (code != MB_CODE_OK) throw error(code);
}

// What to measure and how, with the defaults already set.
struct configuration : mb_configuration {
    configuration() : mb_configuration() { check(mb_configuration_default(this, sizeof(mb_configuration))); }
};

// All that one picture tells; see mb_record for what the fields are.
struct record {
    std::size_t width, height;
    bool linearized, tracked;
    double angle_deg;
    std::optional<double> angle_std_deg, direction_deg;
    double length_px;
    std::optional<double> length_std_px, correlation;
    mb_status status;
    std::string reason; // Why the status is not MB_STATUS_OK; else empty.
    std::optional<double> accel_ratio, accel_ratio_std, accel_ratio_limit;
    std::optional<bool> accel_detected;
    std::optional<double> accel_m_s2, accel_std_m_s2;
    std::optional<double> gain_per_bin, rival_share, incoherent_share, misfit, band_cycles_per_px;
    std::optional<double> exposure_s, scale_m_per_px, scale_std_m_per_px;
    std::optional<double> speed_m_s, speed_std_m_s, speed_expanded_m_s, coverage_k;
    std::optional<double> angular_rate_rad_s, angular_rate_std_rad_s;

    record(const mb_record &c, std::string reason_text)
        : width(c.width), height(c.height), linearized(c.linearized != 0), tracked(c.tracked != 0), angle_deg(c.angle_deg),
          angle_std_deg(known(c.angle_std_deg)), direction_deg(known(c.direction_deg)), length_px(c.length_px),
          length_std_px(known(c.length_std_px)), correlation(known(c.correlation)), status(c.status),
          reason(std::move(reason_text)), accel_ratio(known(c.accel_ratio)), accel_ratio_std(known(c.accel_ratio_std)),
          accel_ratio_limit(known(c.accel_ratio_limit)), accel_m_s2(known(c.accel_m_s2)),
          accel_std_m_s2(known(c.accel_std_m_s2)), gain_per_bin(known(c.gain_per_bin)), rival_share(known(c.rival_share)),
          incoherent_share(known(c.incoherent_share)), misfit(known(c.misfit)),
          band_cycles_per_px(known(c.band_cycles_per_px)), exposure_s(known(c.exposure_s)),
          scale_m_per_px(known(c.scale_m_per_px)), scale_std_m_per_px(known(c.scale_std_m_per_px)),
          speed_m_s(known(c.speed_m_s)), speed_std_m_s(known(c.speed_std_m_s)),
          speed_expanded_m_s(known(c.speed_expanded_m_s)), coverage_k(known(c.coverage_k)),
          angular_rate_rad_s(known(c.angular_rate_rad_s)), angular_rate_std_rad_s(known(c.angular_rate_std_rad_s))
    {
        if (c.accel_detected >= 0) accel_detected = c.accel_detected != 0;
    }

private:
    static std::optional<double> known(double value)
    {
        return std::isnan(value) ? std::nullopt : std::optional<double>(value);
    }
};

// Measures pictures one after the other. One thread at a time may use a meter; it can be moved, not copied.
class meter {
public:
    explicit meter(const mb_configuration &configuration = motion_blur::configuration())
    {
        mb_meter *made = nullptr;
        check(mb_meter_new(&configuration, &made));
        handle_.reset(made);
    }

    // Throws error for a picture that cannot be measured. That it shows no blur is a status.
    record measure(const mb_picture &picture)
    {
        mb_record c{};
        c.struct_size = sizeof c;
        check(mb_meter_measure(handle_.get(), &picture, &c));
        return record(c, text(mb_meter_reason));
    }

    // Forgets the frame before: the next picture does not follow it.
    void reset() { check(mb_meter_reset(handle_.get())); }

    // Name of the method.
    std::string method() const { return text(mb_meter_method); }

private:
    std::string text(std::size_t (*write)(const mb_meter *, char *, std::size_t)) const
    {
        // With room for the zero byte, which the string has too.
        std::string text(write(handle_.get(), nullptr, 0), '\0');
        if (!text.empty()) write(handle_.get(), text.data(), text.size() + 1);
        return text;
    }

    struct free_meter {
        void operator()(mb_meter *meter) const noexcept { mb_meter_free(meter); }
    };
    std::unique_ptr<mb_meter, free_meter> handle_;
};

} // namespace motion_blur

#endif
