-- ARGV: worker, description as JSON, build. A worker is alive; the store forgets it after a minute.
redis.call('ZADD', key('workers'), text(now()), ARGV[1])
redis.call('SET', key('worker', ARGV[1]), ARGV[2], 'PX', '60000')
if ARGV[3] ~= '' then redis.call('SET', key('build'), ARGV[3]) end
return 1
