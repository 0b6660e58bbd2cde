# deltamesh with all readers, and files at URLs. From a checkout:
#
#   docker build -t deltamesh .
#   docker run --rm -v "$PWD:/data" --user "$(id -u):$(id -g)" deltamesh encode scan.ply

FROM python:3.12-slim AS build
WORKDIR /src
COPY pyproject.toml hatch_build.py README.md LICENSE ./
COPY packaging packaging
COPY src src
COPY formats formats
COPY cli cli
# No compiler: that of the wheel ziglang compiles the core.
RUN python -m pip wheel --no-cache-dir --wheel-dir /wheels ".[formats,remote]"

FROM python:3.12-slim
COPY --from=build /wheels /wheels
RUN python -m pip install --no-cache-dir --no-index --find-links /wheels "deltamesh[formats,remote]" \
    && rm -r /wheels
USER nobody
WORKDIR /data
ENTRYPOINT ["deltamesh"]
CMD ["--help"]
