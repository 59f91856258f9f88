/* Measures the motion blur of a picture, or of a region of it, and prints every field of the record: C11. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <motion_blur.h>

#include "pnm.h"

static void number(const char *name, double value)
{
    /* 17 digits tell a double from every other. NaN: not computed. */
    if (!isnan(value)) printf("%s=%.17g\n", name, value);
}

static void print(const mb_meter *meter, const mb_record *record)
{
    char text[256];
    printf("width=%zu\nheight=%zu\n", record->width, record->height);
    mb_meter_method(meter, text, sizeof text);
    printf("method=%s\nlinearized=%d\ntracked=%d\n", text, (int)record->linearized, (int)record->tracked);
    number("angle_deg", record->angle_deg);
    number("angle_std_deg", record->angle_std_deg);
    number("direction_deg", record->direction_deg);
    number("length_px", record->length_px);
    number("length_std_px", record->length_std_px);
    number("correlation", record->correlation);
    printf("status=%s\n", mb_status_name(record->status));
    if (mb_meter_reason(meter, text, sizeof text) > 0) printf("reason=%s\n", text);
    number("accel_ratio", record->accel_ratio);
    number("accel_ratio_std", record->accel_ratio_std);
    number("accel_ratio_limit", record->accel_ratio_limit);
    if (record->accel_detected >= 0) printf("accel_detected=%d\n", (int)record->accel_detected);
    number("accel_m_s2", record->accel_m_s2);
    number("accel_std_m_s2", record->accel_std_m_s2);
    number("gain_per_bin", record->gain_per_bin);
    number("rival_share", record->rival_share);
    number("incoherent_share", record->incoherent_share);
    number("misfit", record->misfit);
    number("band_cycles_per_px", record->band_cycles_per_px);
    number("exposure_s", record->exposure_s);
    number("scale_m_per_px", record->scale_m_per_px);
    number("scale_std_m_per_px", record->scale_std_m_per_px);
    number("speed_m_s", record->speed_m_s);
    number("speed_std_m_s", record->speed_std_m_s);
    number("speed_expanded_m_s", record->speed_expanded_m_s);
    number("coverage_k", record->coverage_k);
    number("angular_rate_rad_s", record->angular_rate_rad_s);
    number("angular_rate_std_rad_s", record->angular_rate_std_rad_s);
}

int main(int count, char **arguments)
{
    if (count != 2 && count != 6) {
        fprintf(stderr, "usage: %s PICTURE [X Y WIDTH HEIGHT]\n", arguments[0]);
        return 2;
    }
    mb_picture picture;
    const char *wrong = pnm_read(arguments[1], &picture);
    if (wrong != NULL) {
        fprintf(stderr, "%s %s\n", arguments[1], wrong);
        return 1;
    }
    void *samples = (void *)picture.data;

    /* Exposure and scale make the length a speed, and the ratio of the acceleration an acceleration. */
    mb_configuration configuration = {sizeof configuration};
    configuration.acceleration = 1;
    configuration.exposure_s = 0.1;
    configuration.exposure_std_s = 1e-4;
    configuration.geometry = MB_GEOMETRY_SCALE;
    configuration.scale_m_per_px = 7.789e-4;
    configuration.scale_std_m_per_px = 2e-6;

    int status = 1;
    mb_meter *meter = NULL;
    mb_record record = {sizeof record};
    if (count == 6 && !pnm_region(&picture, (const char *const *)arguments + 2)) {
        fprintf(stderr, "the region is not inside the picture\n");
    } else if (mb_meter_new(&configuration, &meter) != MB_CODE_OK ||
               mb_meter_measure(meter, &picture, &record) != MB_CODE_OK) {
        fprintf(stderr, "%s\n", mb_error_message());
    } else {
        print(meter, &record);
        status = 0;
    }
    mb_meter_free(meter);
    free(samples);
    return status;
}
