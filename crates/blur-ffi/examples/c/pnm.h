/* Reads the pictures that need no library: PGM and PPM (P5, P6) with 8 or 16 bit, and grey PFM (Pf). For C and C++. */

#ifndef PNM_H
#define PNM_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <motion_blur.h>

/* A number of the header, 1 to most; 0 if there is none. Comments are skipped. */
static long pnm_number(FILE *file, long most)
{
    int c = fgetc(file);
    while (c == '#' || c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        while (c == '#' && c != EOF && (c = fgetc(file)) != '\n' && c != EOF) c = '#';
        c = fgetc(file);
    }
    long value = 0;
    for (; c >= '0' && c <= '9' && value <= most; c = fgetc(file)) value = 10 * value + (c - '0');
    return value <= most ? value : 0;
}

/* Turns samples as they lie in a file, of which the first byte is the highest, into those of this machine. */
static void pnm_to_native(unsigned char *bytes, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++, bytes += size) {
        uint32_t value = 0;
        for (size_t k = 0; k < size; k++) value = value << 8 | bytes[k];
        const uint16_t small = (uint16_t)value;
        if (size == 2) memcpy(bytes, &small, sizeof small);
        if (size == 4) memcpy(bytes, &value, sizeof value);
    }
}

/* Fills a picture, whose samples are to be freed by free((void *)picture->data). Returns what is wrong, or null. */
static const char *pnm_read(const char *path, mb_picture *picture)
{
    const long most_side = 16384;
    FILE *file = fopen(path, "rb");
    if (file == NULL) return "cannot be opened";
    char kind[2] = {0, 0};
    const char *wrong = NULL;
    unsigned char *bytes = NULL;
    if (fread(kind, 1, 2, file) != 2 || kind[0] != 'P' || strchr("56f", kind[1]) == NULL || kind[1] == 0) {
        fclose(file);
        return "is no PGM, PPM or grey PFM";
    }
    const int is_float = kind[1] == 'f', is_colour = kind[1] == '6';
    const long width = pnm_number(file, most_side), height = pnm_number(file, most_side);
    double scale = 1.0;
    long maximum = 255;
    if (is_float) {
        if (fscanf(file, "%lf", &scale) != 1 || fgetc(file) == EOF) scale = 0.0;
    } else {
        maximum = pnm_number(file, 65535);
    }
    /* Codes of 10 or 12 bit would first have to be brought to full scale. */
    if (width == 0 || height == 0 || (maximum != 255 && maximum != 65535) || (scale != 1.0 && scale != -1.0)) {
        fclose(file);
        return "has a header that is not understood";
    }
    const size_t size = is_float ? 4 : maximum > 255 ? 2 : 1;
    const size_t row = (size_t)width * size * (is_colour ? 3 : 1);
    bytes = (unsigned char *)malloc(row * (size_t)height);
    if (bytes == NULL) wrong = "is too large for the memory";
    for (long i = 0; i < height && wrong == NULL; i++) {
        /* The rows of a PFM come from the bottom to the top. */
        unsigned char *to = bytes + row * (size_t)(is_float ? height - 1 - i : i);
        if (fread(to, 1, row, file) != row) wrong = "ends too early";
        if (is_float && scale < 0.0) {
            for (unsigned char *p = to; p < to + row; p += 4) {
                const unsigned char last[2] = {p[3], p[2]};
                p[3] = p[0], p[2] = p[1], p[0] = last[0], p[1] = last[1];
            }
        }
        pnm_to_native(to, row / size, size);
    }
    fclose(file);
    if (wrong != NULL) {
        free(bytes);
        return wrong;
    }
    picture->struct_size = sizeof *picture;
    picture->data = bytes;
    picture->width = (size_t)width;
    picture->height = (size_t)height;
    picture->row_bytes = (ptrdiff_t)row;
    picture->sample = is_float ? MB_SAMPLE_F32 : size == 2 ? MB_SAMPLE_U16 : MB_SAMPLE_U8;
    picture->channels = is_colour ? MB_CHANNELS_RGB : MB_CHANNELS_GREY;
    return NULL;
}

/* A region of a picture: the same memory, of which less is looked at. Returns 0 if it lies outside. */
static int pnm_region(mb_picture *picture, const char *const numbers[4])
{
    const size_t x = strtoul(numbers[0], NULL, 10), y = strtoul(numbers[1], NULL, 10);
    const size_t width = strtoul(numbers[2], NULL, 10), height = strtoul(numbers[3], NULL, 10);
    if (x > picture->width || y > picture->height || width > picture->width - x || height > picture->height - y) return 0;
    const size_t pixel = (size_t)picture->row_bytes / picture->width;
    picture->data = (const unsigned char *)picture->data + y * (size_t)picture->row_bytes + x * pixel;
    picture->width = width;
    picture->height = height;
    return 1;
}

#endif
