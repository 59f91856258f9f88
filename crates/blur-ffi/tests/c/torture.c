/* Everything that a C program can do wrong, and many things at once. Run under sanitizers, which see what is read or written
 * beyond its end, and what is never freed. `torture leak` and `torture overread` do what they must see, and so must fail. */

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <motion_blur.h>

#define CHECK(what)                                                                                                            \
    do {                                                                                                                       \
        if (!(what)) {                                                                                                         \
            fprintf(stderr, "%s:%d: not so: %s; last message: %s\n", __FILE__, __LINE__, #what, mb_error_message());           \
            exit(1);                                                                                                           \
        }                                                                                                                      \
    } while (0)

enum { SIDE = 96, BLUR = 12, THREADS = 4 };

/* Grey codes of random blocks that moved by BLUR pixels to the right during the exposure, from a fixed seed. */
static unsigned char code_at(size_t row, size_t column)
{
    unsigned sum = 0;
    for (size_t i = 0; i < BLUR; i++) {
        uint32_t hash = (uint32_t)((row / 3) * 7919 + (column + i) / 3 * 104729);
        hash ^= hash >> 15, hash *= 0x2c1b3c6du, hash ^= hash >> 12, hash *= 0x297a2d39u, hash ^= hash >> 15;
        sum += hash & 255;
    }
    return (unsigned char)(sum / BLUR);
}

/* A picture that ends with its allocation. */
static unsigned char *make_picture(mb_picture *picture)
{
    unsigned char *samples = malloc(SIDE * SIDE);
    CHECK(samples != NULL);
    for (size_t i = 0; i < SIDE * SIDE; i++) samples[i] = code_at(i / SIDE, i % SIDE);
    *picture = (mb_picture){sizeof *picture, samples, SIDE, SIDE, SIDE, MB_SAMPLE_U8, MB_CHANNELS_GREY};
    return samples;
}

static mb_meter *make_meter(void)
{
    mb_configuration configuration;
    CHECK(mb_configuration_default(&configuration, sizeof configuration) == MB_CODE_OK);
    mb_meter *meter = NULL;
    CHECK(mb_meter_new(&configuration, &meter) == MB_CODE_OK);
    return meter;
}

static mb_record measure(mb_meter *meter, const mb_picture *picture)
{
    mb_record record = {sizeof record};
    CHECK(mb_meter_measure(meter, picture, &record) == MB_CODE_OK);
    return record;
}

static int same(const mb_record *a, const mb_record *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static void null_pointers(const mb_picture *picture)
{
    mb_configuration configuration = {sizeof configuration};
    mb_meter *meter = make_meter();
    mb_record record = {sizeof record};
    CHECK(mb_configuration_default(NULL, sizeof configuration) == MB_CODE_NULL_POINTER);
    CHECK(mb_meter_new(&configuration, NULL) == MB_CODE_NULL_POINTER);
    mb_meter *none = meter;
    CHECK(mb_meter_new(NULL, &none) == MB_CODE_NULL_POINTER && none == NULL);
    CHECK(mb_meter_measure(NULL, picture, &record) == MB_CODE_NULL_POINTER);
    CHECK(mb_meter_measure(meter, NULL, &record) == MB_CODE_NULL_POINTER);
    CHECK(mb_meter_measure(meter, picture, NULL) == MB_CODE_NULL_POINTER);
    CHECK(mb_meter_reset(NULL) == MB_CODE_NULL_POINTER);
    CHECK(mb_meter_reason(NULL, NULL, 0) == 0 && mb_meter_method(NULL, NULL, 0) == 0);
    CHECK(strlen(mb_error_message()) > 0);
    mb_meter_free(NULL);
    mb_meter_free(meter);
}

static void sizes_of_structures(const mb_picture *picture)
{
    struct {
        mb_picture known;
        uint64_t newer;
    } grown = {*picture, 0};
    mb_meter *meter = make_meter();
    mb_record record = {sizeof record};
    grown.known.struct_size = sizeof grown;
    CHECK(mb_meter_measure(meter, &grown.known, &record) == MB_CODE_OK);
    grown.newer = 1;
    CHECK(mb_meter_measure(meter, &grown.known, &record) == MB_CODE_STRUCT_SIZE);
    const size_t wrong[] = {0, 1, sizeof(size_t), sizeof *picture - 1, 5000, SIZE_MAX};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        mb_picture bad = *picture;
        bad.struct_size = wrong[i];
        CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_STRUCT_SIZE);
        mb_configuration configuration = {wrong[i]};
        mb_meter *none = NULL;
        CHECK(mb_meter_new(&configuration, &none) == MB_CODE_STRUCT_SIZE && none == NULL);
        record.struct_size = wrong[i];
        CHECK(mb_meter_measure(meter, picture, &record) == MB_CODE_STRUCT_SIZE);
        record.struct_size = sizeof record;
    }
    mb_meter_free(meter);
}

static void layouts(const mb_picture *picture)
{
    mb_meter *meter = make_meter();
    mb_record record = {sizeof record};
    const ptrdiff_t rows[] = {0, -1, -SIDE, SIDE - 1, PTRDIFF_MIN};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        mb_picture bad = *picture;
        bad.row_bytes = rows[i];
        CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_LAYOUT);
        CHECK(strstr(mb_error_message(), "row_bytes") != NULL);
    }
    mb_picture bad = *picture;
    bad.width = bad.height = SIZE_MAX / 2;
    CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_LAYOUT);
    bad = *picture, bad.height = SIZE_MAX;
    CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_LAYOUT);
    bad = *picture, bad.width = 31;
    CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_PICTURE);
    bad = *picture, bad.height = 0;
    CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_PICTURE);
    bad = *picture, bad.data = NULL;
    CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_NULL_POINTER);
    for (int value = -2; value < 9; value++) {
        bad = *picture, bad.sample = value;
        if (value < 0 || value > 2) CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_UNKNOWN_VALUE);
        bad = *picture, bad.channels = value;
        if (value < 0 || value > 5) CHECK(mb_meter_measure(meter, &bad, &record) == MB_CODE_UNKNOWN_VALUE);
    }
    mb_meter_free(meter);
}

/* Samples at any address, and the orders of colours, change nothing. */
static void forms(const mb_picture *picture, const unsigned char *codes)
{
    mb_meter *meter = make_meter();
    const mb_record grey = measure(meter, picture);
    CHECK(grey.status == MB_STATUS_OK && fabs(grey.length_px - BLUR) < 1.0);
    for (size_t shift = 0; shift < 8; shift++) {
        /* Ends with the allocation, whatever the shift. */
        unsigned char *bytes = malloc(shift + sizeof(float) * SIDE * SIDE);
        CHECK(bytes != NULL);
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            const float value = codes[i];
            memcpy(bytes + shift + sizeof value * i, &value, sizeof value);
        }
        mb_picture floats = *picture;
        floats.data = bytes + shift, floats.row_bytes = SIDE * sizeof(float), floats.sample = MB_SAMPLE_F32;
        const mb_record found = measure(meter, &floats);
        CHECK(same(&found, &grey));
        const float hole = NAN;
        memcpy(bytes + shift + sizeof hole * (SIDE * SIDE - 1), &hole, sizeof hole);
        mb_record record = {sizeof record};
        CHECK(mb_meter_measure(meter, &floats, &record) == MB_CODE_PICTURE);
        CHECK(strstr(mb_error_message(), "row 95, column 95") != NULL);
        free(bytes);
    }
    unsigned char *colours = malloc(3 * SIDE * SIDE);
    CHECK(colours != NULL);
    mb_record found[2];
    for (int order = 0; order < 2; order++) {
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            colours[3 * i + (order == 0 ? 0 : 2)] = codes[i];
            colours[3 * i + 1] = codes[i] / 2;
            colours[3 * i + (order == 0 ? 2 : 0)] = (unsigned char)(i % 251);
        }
        mb_picture coloured = *picture;
        coloured.data = colours, coloured.row_bytes = 3 * SIDE;
        coloured.channels = order == 0 ? MB_CHANNELS_RGB : MB_CHANNELS_BGR;
        found[order] = measure(meter, &coloured);
    }
    CHECK(same(&found[0], &found[1]) && !same(&found[0], &grey));
    free(colours);
    mb_meter_free(meter);
}

static void texts(const mb_picture *picture)
{
    mb_configuration configuration = {sizeof configuration};
    configuration.method = "whittle";
    configuration.length_min_px = 30.0, configuration.length_max_px = 40.0;
    mb_meter *meter = NULL;
    CHECK(mb_meter_new(&configuration, &meter) == MB_CODE_OK);
    CHECK(measure(meter, picture).status != MB_STATUS_OK);
    const size_t length = mb_meter_reason(meter, NULL, 0);
    CHECK(length > 10);
    for (size_t capacity = 0; capacity <= length + 2; capacity++) {
        char *buffer = malloc(capacity + 1);
        CHECK(buffer != NULL);
        memset(buffer, 'x', capacity + 1);
        CHECK(mb_meter_reason(meter, buffer, capacity) == length && buffer[capacity] == 'x');
        if (capacity > 0) CHECK(strlen(buffer) == (length < capacity ? length : capacity - 1));
        free(buffer);
    }
    char name[16];
    CHECK(mb_meter_method(meter, name, sizeof name) == 7 && strcmp(name, "whittle") == 0);
    CHECK(mb_meter_reset(meter) == MB_CODE_OK && mb_meter_reason(meter, NULL, 0) == 0);
    configuration.method = "a name that is none";
    mb_meter *none = NULL;
    CHECK(mb_meter_new(&configuration, &none) == MB_CODE_CONFIGURATION && none == NULL);
    CHECK(strstr(mb_error_message(), configuration.method) != NULL);
    CHECK(strcmp(mb_version(), MB_VERSION) == 0);
    mb_meter_free(meter);
}

static void many(const mb_picture *picture)
{
    mb_meter *meters[200];
    for (size_t i = 0; i < 200; i++) meters[i] = make_meter();
    const mb_record first = measure(meters[0], picture);
    for (size_t i = 0; i < 200; i += 40) {
        /* Another size between makes and frees the plans. */
        mb_picture part = *picture;
        part.width = 64;
        measure(meters[i], &part);
        const mb_record again = measure(meters[i], picture);
        CHECK(same(&first, &again));
    }
    for (size_t i = 0; i < 200; i++) mb_meter_free(meters[(i * 77) % 200]);
}

struct job {
    const mb_picture *picture;
    mb_meter *shared;
    mb_record expected;
    int own_done, shared_done, shared_busy;
};

static void *work(void *argument)
{
    struct job *job = argument;
    mb_meter *meter = make_meter();
    CHECK(strcmp(mb_error_message(), "") == 0);
    CHECK(mb_meter_reset(NULL) == MB_CODE_NULL_POINTER);
    for (int i = 0; i < 10; i++) {
        const mb_record own = measure(meter, job->picture);
        job->own_done += same(&own, &job->expected);
        mb_record record = {sizeof record};
        const mb_code code = mb_meter_measure(job->shared, job->picture, &record);
        CHECK(code == MB_CODE_OK || code == MB_CODE_BUSY);
        if (code == MB_CODE_OK) job->shared_done += same(&record, &job->expected);
        else job->shared_busy += 1;
    }
    mb_meter_free(meter);
    return NULL;
}

static void threads(const mb_picture *picture)
{
    pthread_t ids[THREADS];
    struct job jobs[THREADS];
    mb_meter *shared = make_meter();
    const mb_record expected = measure(shared, picture);
    for (int i = 0; i < THREADS; i++) {
        jobs[i] = (struct job){picture, shared, expected, 0, 0, 0};
        CHECK(pthread_create(&ids[i], NULL, work, &jobs[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) CHECK(pthread_join(ids[i], NULL) == 0);
    for (int i = 0; i < THREADS; i++) {
        CHECK(jobs[i].own_done == 10 && jobs[i].shared_done + jobs[i].shared_busy == 10);
    }
    mb_meter_free(shared);
}

int main(int count, char **arguments)
{
    mb_picture picture;
    unsigned char *samples = make_picture(&picture);
    if (count == 2 && strcmp(arguments[1], "leak") == 0) {
        measure(make_meter(), &picture);
    } else if (count == 2 && strcmp(arguments[1], "overread") == 0) {
        picture.height += 1;
        mb_meter *meter = make_meter();
        measure(meter, &picture);
        mb_meter_free(meter);
    } else {
        null_pointers(&picture);
        sizes_of_structures(&picture);
        layouts(&picture);
        forms(&picture, samples);
        texts(&picture);
        many(&picture);
        threads(&picture);
        puts("nothing broke");
    }
    free(samples);
    return 0;
}
