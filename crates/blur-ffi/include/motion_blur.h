/* Motion blur measured from C and C++: direction, length, speed and acceleration with their uncertainties, of one picture.
 *
 * Made from crates/blur-ffi/src by: REGENERATE=1 cargo test -p blur-ffi --test header
 *
 *     mb_configuration configuration = {sizeof configuration};
 *     mb_meter *meter;
 *     if (mb_meter_new(&configuration, &meter) != MB_CODE_OK) puts(mb_error_message());
 *     mb_picture picture = {sizeof picture, samples, width, height, row_bytes, MB_SAMPLE_U8, MB_CHANNELS_GREY};
 *     mb_record record = {sizeof record};
 *     if (mb_meter_measure(meter, &picture, &record) != MB_CODE_OK) puts(mb_error_message());
 *     mb_meter_free(meter);
 *
 * Structures begin with their size, so that they may grow: fields are only ever added at the end, and zero bytes stand for
 * defaults. All functions may be called from any thread, but one meter by one thread at a time. Nothing is thrown. When there
 * is no memory left the process ends.
 *
 * Licence: MIT or Apache-2.0. */

#ifndef MOTION_BLUR_H
#define MOTION_BLUR_H

#include <stddef.h>
#include <stdint.h>

/* Version of this header; that of the library that runs is mb_version(). */
#define MB_VERSION "0.1.0"
#define MB_VERSION_MAJOR 0
#define MB_VERSION_MINOR 1
#define MB_VERSION_PATCH 0

// What became of a call. The numbers never change.
typedef enum {
    // It did what it says.
    MB_CODE_OK = 0,
    // A pointer is null that must not be.
    MB_CODE_NULL_POINTER = 1,
    // The field struct_size of a structure is not a size that this library can read.
    MB_CODE_STRUCT_SIZE = 2,
    // A number is not one of its enumeration.
    MB_CODE_UNKNOWN_VALUE = 3,
    // Rows of a picture overlap, run backwards, or reach beyond what can be addressed.
    MB_CODE_LAYOUT = 4,
    // The configuration is not allowed.
    MB_CODE_CONFIGURATION = 5,
    // The picture cannot be measured: too small, constant, not finite, or of another shape than the camera's.
    MB_CODE_PICTURE = 6,
    // Another thread is using the handle.
    MB_CODE_BUSY = 7,
    // An earlier call on the handle failed with MB_CODE_INTERNAL: free it and make another.
    MB_CODE_POISONED = 8,
    // A defect of the library.
    MB_CODE_INTERNAL = 9,
} mb_code;

// How far a result can be trusted.
typedef enum {
    // The method's own checks passed.
    MB_STATUS_OK = 0,
    // There is an answer, and a reason not to trust it: see mb_meter_reason.
    MB_STATUS_LOW_CONFIDENCE = 1,
    // The picture shows no motion blur that the method can see: see mb_meter_reason.
    MB_STATUS_NO_MOTION_BLUR = 2,
} mb_status;

// Window laid over a picture before its transform.
typedef enum {
    // The method's own choice.
    MB_WINDOW_METHOD = 0,
    // No taper: the picture as it is.
    MB_WINDOW_NONE = 1,
    // Raised cosine over the whole length.
    MB_WINDOW_HANN = 2,
} mb_window;

// What turns the pixels of a blur into metres or radians.
typedef enum {
    // Nothing: there is no speed.
    MB_GEOMETRY_NONE = 0,
    // The motion is in a plane of scale_m_per_px.
    MB_GEOMETRY_SCALE = 1,
    // A calibrated camera sees a motion in a plane at distance_m, parallel to its sensor.
    MB_GEOMETRY_PLANE = 2,
    // A calibrated camera turns in front of a scene at rest.
    MB_GEOMETRY_ROTATION = 3,
} mb_geometry;

// Type of one sample.
typedef enum {
    // Integer, 0 to 255.
    MB_SAMPLE_U8 = 0,
    // Integer, 0 to 65535, in the machine's order of bytes.
    MB_SAMPLE_U16 = 1,
    // float, already linear in light. Every one must be finite.
    MB_SAMPLE_F32 = 2,
} mb_sample;

// The samples of one pixel, in their order. Alpha is not looked at.
typedef enum {
    // Grey.
    MB_CHANNELS_GREY = 0,
    // Grey, then alpha.
    MB_CHANNELS_GREY_ALPHA = 1,
    // Red, green, blue.
    MB_CHANNELS_RGB = 2,
    // Red, green, blue, alpha.
    MB_CHANNELS_RGBA = 3,
    // Blue, green, red: the order of OpenCV.
    MB_CHANNELS_BGR = 4,
    // Blue, green, red, alpha.
    MB_CHANNELS_BGRA = 5,
} mb_channels;

// Measures pictures one after the other. Plans and buffers are made with the first picture of a size. One thread at a time
// may use a meter, not always the same one; different meters are independent of each other.
typedef struct mb_meter mb_meter;

// A calibrated camera, a pinhole with lens distortion; model and order are those of OpenCV. Begin with
// mb_camera camera = {sizeof camera};
typedef struct {
    // Its size in bytes: sizeof(mb_camera).
    size_t struct_size;
    // Columns of the pictures that it was calibrated with. Pictures to measure may be larger or smaller, of one shape.
    size_t width_px;
    // Rows.
    size_t height_px;
    // fx, fy, cx, cy, skew in pixels, then k1, k2, p1, p2, k3.
    double parameters[10];
    // Covariance of the parameters, row by row; 0 where a parameter counts as exact.
    double covariance[10][10];
} mb_camera;

// What to measure and how. Zeros are the defaults, so mb_configuration configuration = {sizeof configuration}; measures
// direction and length with the recommended method. What is not of the chosen geometry is not looked at.
typedef struct {
    // Its size in bytes: sizeof(mb_configuration).
    size_t struct_size;
    // Name of the method, such as "whittle" or "dct-radon+dct-pseudo-cepstrum"; null for the recommended one.
    const char *method;
    // One of mb_window.
    int32_t window;
    // Not 0: look for an acceleration too. Only the method "whittle" can.
    int32_t acceleration;
    // Not 0: integer samples follow the sRGB tone curve, which is undone, since motion mixes light.
    int32_t linearize;
    // Not 0: pictures are frames that follow each other; a fit may start from the result of the frame before.
    int32_t tracking;
    // Not 0: pictures are frames that follow each other; the displacement since the frame before tells a motion from its
    // opposite.
    int32_t directed;
    // One of mb_geometry.
    int32_t geometry;
    // Shortest length to search in pixels, at least 2; 0 and 0: from 4 px to what the size of the picture allows.
    double length_min_px;
    // Longest length to search in pixels.
    double length_max_px;
    // Exposure of every picture in seconds; 0: unknown, so there is no speed.
    double exposure_s;
    // Its standard uncertainty.
    double exposure_std_s;
    // For MB_GEOMETRY_SCALE: metres in the scene for each pixel.
    double scale_m_per_px;
    // Its standard uncertainty.
    double scale_std_m_per_px;
    // For MB_GEOMETRY_PLANE: distance from the camera to the plane in metres.
    double distance_m;
    // Its standard uncertainty.
    double distance_std_m;
    // For MB_GEOMETRY_PLANE and MB_GEOMETRY_ROTATION: the camera. It is copied.
    const mb_camera *camera;
} mb_configuration;

// A picture in the memory of the caller, upright, the top row first. It is only read, during the call. Grey float samples
// at addresses and distances of rows that are multiples of 4 are not even copied. Begin with
// mb_picture picture = {sizeof picture};
typedef struct {
    // Its size in bytes: sizeof(mb_picture).
    size_t struct_size;
    // The first sample of the top row.
    const void *data;
    // Columns, at least 32.
    size_t width;
    // Rows, at least 32.
    size_t height;
    // Bytes from the start of a row to the start of the next, at least those of a row. What lies between is not read.
    ptrdiff_t row_bytes;
    // One of mb_sample.
    int32_t sample;
    // One of mb_channels.
    int32_t channels;
} mb_picture;

// All that one picture tells. A number that was not computed is NaN. Uncertainties are standard uncertainties (one standard
// deviation). Begin with mb_record record = {sizeof record};
typedef struct {
    // Its size in bytes: sizeof(mb_record). An older library sets it to what it knows, and leaves what is beyond as it was.
    size_t struct_size;
    // Columns of the picture.
    size_t width;
    // Rows of the picture.
    size_t height;
    // How far to trust the result.
    mb_status status;
    // 1 if the sRGB tone curve was undone first, else 0.
    int32_t linearized;
    // 1 if the fit started from the result of the frame before instead of a search, else 0.
    int32_t tracked;
    // 1 if the acceleration stands out from a uniform motion, 0 if not, -1 if it was not looked for.
    int32_t accel_detected;
    // Axis of the motion in degrees, from 0 to below 180, counter-clockwise from +x as seen (y up).
    double angle_deg;
    // Its standard uncertainty.
    double angle_std_deg;
    // Where the content of the picture moved, in degrees, from 0 to below 360, when that is known.
    double direction_deg;
    // Blur length in pixels.
    double length_px;
    // Its standard uncertainty.
    double length_std_px;
    // Correlation coefficient of angle and length.
    double correlation;
    // The ratio a T / (2 v): without its sign unless the method knows it.
    double accel_ratio;
    // Its standard uncertainty.
    double accel_ratio_std;
    // The least ratio that counts as detected.
    double accel_ratio_limit;
    // Acceleration in metres per second squared.
    double accel_m_s2;
    // Its combined standard uncertainty.
    double accel_std_m_s2;
    // Gain in log-likelihood over no blur, for each bin of signal.
    double gain_per_bin;
    // Evidence for the best other blur, relative to the one found.
    double rival_share;
    // Share of the light that does not follow the motion.
    double incoherent_share;
    // Mean squared standardised residual of the spectrum.
    double misfit;
    // Highest frequency that the result rests on, in cycles per pixel.
    double band_cycles_per_px;
    // Exposure time in seconds.
    double exposure_s;
    // Metres in the scene for each pixel of the blur as measured.
    double scale_m_per_px;
    // Its standard uncertainty.
    double scale_std_m_per_px;
    // Mean speed during the exposure in metres per second.
    double speed_m_s;
    // Its combined standard uncertainty.
    double speed_std_m_s;
    // Its expanded uncertainty, coverage_k times the standard uncertainty.
    double speed_expanded_m_s;
    // The coverage factor: about 95 % for a normal distribution.
    double coverage_k;
    // How fast the camera turned in radians per second, when it did in front of a scene at rest.
    double angular_rate_rad_s;
    // Its combined standard uncertainty.
    double angular_rate_std_rad_s;
} mb_record;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library that runs, such as "0.1.0"; MB_VERSION is that of the header.
const char *mb_version(void);

// Why the last call that failed on this thread did, as one line of text; empty when none has failed. It stays valid until
// the next call on this thread fails, and is never null.
const char *mb_error_message(void);

// Sets all fields of a configuration to their defaults. struct_size is sizeof(mb_configuration).
//
// What the caller promises:
// `configuration` is null or points to `struct_size` writable bytes.
mb_code mb_configuration_default(mb_configuration *configuration, size_t struct_size);

// Makes a meter and writes it to *meter; free it with mb_meter_free. On failure *meter becomes null.
//
// What the caller promises:
// `configuration` is null or points to a configuration as its documentation says; `meter` is null or points to a pointer.
mb_code mb_meter_new(const mb_configuration *configuration,
                     mb_meter **meter);

// Frees a meter; null is allowed, and nothing is done.
//
// What the caller promises:
// `meter` is null or came from `mb_meter_new`, was not freed before, and is in use by no thread.
void mb_meter_free(mb_meter *meter);

// Measures a picture and fills *record. On failure *record stays as it is. That a picture shows no blur, or that the result
// is in doubt, is no failure but a status.
//
// What the caller promises:
// `meter` is null or came from `mb_meter_new`; `picture` and `record` are null or point to what their documentation says; the
// samples are readable and nobody writes to them during the call.
mb_code mb_meter_measure(mb_meter *meter,
                         const mb_picture *picture,
                         mb_record *record);

// Forgets the frame before: the next picture does not follow it.
//
// What the caller promises:
// `meter` is null or came from `mb_meter_new`.
mb_code mb_meter_reset(mb_meter *meter);

// Writes the name of the method to buffer, cut to capacity with the zero byte at its end, and returns its whole length
// without that; 0 on failure.
//
// What the caller promises:
// `meter` is null or came from `mb_meter_new`; `buffer` is null or points to `capacity` writable bytes.
size_t mb_meter_method(const mb_meter *meter, char *buffer, size_t capacity);

// Writes why the status of the last picture that was measured is not MB_STATUS_OK to buffer, as one line of text, cut to
// capacity with the zero byte at its end, and returns its whole length without that. 0 and an empty text if the status was
// MB_STATUS_OK, none was measured, or on failure. 256 bytes are enough for every reason.
//
// What the caller promises:
// As `mb_meter_method`.
size_t mb_meter_reason(const mb_meter *meter,
                       char *buffer,
                       size_t capacity);

// The name of a status in machine-readable output: "ok", "low_confidence" or "no_motion_blur"; empty for any other number.
const char *mb_status_name(int32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MOTION_BLUR_H */
